// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fleet/desk/pages.h"
#include "fleet/desk/query_pool.h"
#include "gateway/access/access_control.h"
#include "gateway/http/static_files.h"

namespace dts::fleet::desk {

/// Maps paths to pages. Thread: io.
///
///     /api/me /api/login /api/logout    AccessControl
///     /api/fleet/...                    pages.h, for users who may view
///     everything else                   the dashboard's files
class Routes {
 public:
  Routes(gateway::AccessControl& access, const gateway::StaticFiles& files, QueryPool& queries, std::string version)
      : access_(access), files_(files), queries_(queries), version_(std::move(version)) {}
  void handle(gateway::HttpRequest request, gateway::Respond respond);

 private:
  void serve_fleet(const gateway::HttpRequest& request, gateway::Respond respond);
  void serve_measures(gateway::Respond respond);

  gateway::AccessControl& access_;
  const gateway::StaticFiles& files_;
  QueryPool& queries_;
  std::string version_;
  std::optional<core::Result<std::string>> measures_;  ///< The answer of a moment ago: it counts all results.
  std::chrono::steady_clock::time_point measured_at_{};
  std::vector<gateway::Respond> await_measures_;  ///< Requests that wait for the count under way.
};

/// Read the query of a request. Fail with InvalidArgument.
[[nodiscard]] core::Result<SessionFilter> session_filter(const gateway::Query& query);
[[nodiscard]] core::Result<TrendFilter> trend_filter(const gateway::Query& query);

}  // namespace dts::fleet::desk
