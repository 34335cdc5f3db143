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

/// The contents of `top`, from the daemon's status: rates, losses with their causes, fill levels of the queues, latencies. Latencies cover
/// the last ten seconds, or the time since the daemon's start while less was seen.
class HealthView {
 public:
  void update(const v1::StatusSnapshot& status);

  /// Returns lines for people, with the table in `columns` columns; nothing before the first status.
  [[nodiscard]] std::vector<std::string> lines(std::size_t columns) const;
  /// Returns one object; keys as in the .proto files if they mean the same.
  [[nodiscard]] cli::Json json() const;

 private:
  [[nodiscard]] std::optional<double> latency_ms(const v1::RigStatus& rig, double share) const;
  [[nodiscard]] cli::Json rig_json(const v1::RigStatus& rig) const;
  [[nodiscard]] std::vector<std::string> table(std::size_t columns) const;

  std::deque<v1::StatusSnapshot> seen_;  ///< From one run of the daemon, oldest first.
};

}  // namespace dts::ctl
