// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/log.h"
#include "dts/v1/control.pb.h"
#include "dts/v1/fleet.pb.h"

namespace dts::fleet::forward {

inline constexpr std::string_view kStatusTopic = "dtsd/status";

/// Who at the centre watches which topics, each for 10 s from the last request. Thread: one.
class Viewers {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Viewers(bool is_allowed, core::Log log) : is_allowed_(is_allowed), log_(std::move(log)) {}

  /// Leases the topics, or returns why not. `status`: dtsd's newest; nullptr: dtsd does not answer.
  [[nodiscard]] v1::LiveAnswer handle(const v1::LiveRequest& request, const v1::StatusSnapshot* status, Time now);
  /// Ends leases that were not renewed.
  void expire(Time now);

  /// Topics that are watched, sorted.
  [[nodiscard]] std::vector<std::string> topics() const;
  /// Who watches, sorted.
  [[nodiscard]] std::vector<std::string> names() const;

 private:
  bool is_allowed_;
  core::Log log_;
  std::map<std::string, Time> topics_;  ///< Until when.
  std::map<std::string, Time> names_;   ///< The same for people.
  Time refused_at_{};                   ///< When a rejected request was last logged.
};

}  // namespace dts::fleet::forward
