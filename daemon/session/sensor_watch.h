// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/block.h"
#include "core/latest_value.h"

namespace dts::session {

/// Quality bits that were set in every scan of the last second, by sensor.
struct SensorDoubts {
  std::size_t sensor_count = 0;
  std::array<std::uint8_t, core::kMaxChannels> bits{};
};

/// Finds sensors that do not measure from the quality bits set by the stages `guard` and `linearise`. Makes no judgement of its own.
class SensorWatch {
 public:
  /// `period_scans`: about a second.
  SensorWatch(std::size_t sensor_count, std::uint64_t period_scans);

  /// Adds a block with one column per sensor; ignores a block with any other number of columns. Thread: rig. Realtime-safe: yes.
  void add(const core::Block& sensors) noexcept;
  /// Returns the last complete period. Thread: control (the one reader).
  [[nodiscard]] const SensorDoubts& latest() noexcept { return latest_.load(); }

 private:
  std::uint64_t period_scans_;
  std::uint64_t scans_ = 0;
  SensorDoubts current_;
  core::LatestValue<SensorDoubts> latest_;
};

/// Returns which sensors do not measure, why, and what to do; empty if all measure. `names`: the names of the sensors' channels; `advice`:
/// "check plug and supply".
[[nodiscard]] std::string sensor_problems(const SensorDoubts& doubts, const std::vector<std::string>& names, std::string_view advice);

}  // namespace dts::session
