// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <map>
#include <memory>
#include <string>

#include "fleet/desk/query_pool.h"
#include "fleet/link/link.h"
#include "gateway/access/identity.h"
#include "gateway/http/tab.h"

namespace dts::fleet::desk {

class ClinicView;

/// The live views: one for each clinic that a tab watches, kept while a tab has it. Thread: io. Outlives its tabs.
class Live {
 public:
  /// `link` and `queries` outlive it.
  Live(boost::asio::io_context& io, link::Link& link, QueryPool& queries, std::string version);
  ~Live();
  Live(const Live&) = delete;
  Live& operator=(const Live&) = delete;
  Live(Live&&) = delete;
  Live& operator=(Live&&) = delete;

  /// `clinic`: from the address of the tab, not trusted. Closes the connection if it is not the name of a clinic.
  [[nodiscard]] std::unique_ptr<gateway::Tab> open_tab(const gateway::Identity& identity, const std::string& clinic,
                                                       gateway::TabConnection& connection);

 private:
  boost::asio::io_context& io_;
  link::Link& link_;
  QueryPool& queries_;
  std::string version_;
  std::map<std::string, std::weak_ptr<ClinicView>> views_;
};

}  // namespace dts::fleet::desk
