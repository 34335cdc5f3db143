// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "cli/json.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// What `top` shows of the daemon's status: how much comes, what is lost and why, how full the queues are, how long blocks take. Latencies
/// are of the last ten seconds, or since the daemon's start while less has been seen.
class HealthView {
 public:
  void take(const v1::StatusSnapshot& status);

  /// For people, the table in `columns` columns; nothing before the first status.
  [[nodiscard]] std::vector<std::string> lines(std::size_t columns) const;
  /// One object; keys as in the .proto files where they say the same.
  [[nodiscard]] cli::Json json() const;

 private:
  [[nodiscard]] std::optional<double> latency_ms(const v1::RigStatus& rig, double share) const;
  [[nodiscard]] cli::Json rig_json(const v1::RigStatus& rig) const;
  [[nodiscard]] std::vector<std::string> table(std::size_t columns) const;

  std::deque<v1::StatusSnapshot> seen_;  ///< Of one daemon, oldest first.
};

}  // namespace dts::ctl
