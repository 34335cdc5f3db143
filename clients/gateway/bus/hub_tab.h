// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "dts/v1/gateway.pb.h"
#include "gateway/access/identity.h"
#include "gateway/bus/carried.h"
#include "gateway/bus/command_pool.h"
#include "gateway/bus/tab_queue.h"
#include "gateway/http/tab.h"

namespace dts::gateway {

class Hub;

/// One browser tab: its queue, its timer, its commands.
class HubTab final : public Tab {
 public:
  HubTab(Hub& hub, boost::asio::io_context& io, CommandPool* commands, Identity identity, TabConnection& connection);
  ~HubTab() override;

  void on_message(std::string_view message) override;

  void welcome(const std::string& version, const v1::Link& link);
  void send_link(const v1::Link& link);
  void push(const CarriedPointer& message);
  [[nodiscard]] const std::vector<std::string>& prefixes() const noexcept { return queue_.prefixes(); }
  [[nodiscard]] const TabQueue::Dropped& dropped() const noexcept { return queue_.dropped(); }

 private:
  void on_subscribe(v1::Subscribe&& wanted);
  void on_request(v1::Request&& request);
  void answer_clock(const v1::ClockProbe& probe);
  void refuse(const std::string& request_id, const client::Error& error);
  void arm();
  void send(const v1::FromGateway& message);

  Hub& hub_;
  CommandPool* commands_;
  Identity identity_;
  TabConnection& connection_;
  TabQueue queue_;
  boost::asio::steady_timer timer_;
  bool is_armed_ = false;
  std::size_t commands_under_way_ = 0;
  std::shared_ptr<HubTab*> self_;  ///< Pending answers hold it weakly: the tab may close before they arrive.
};

}  // namespace dts::gateway
