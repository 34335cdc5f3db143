// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "sim/cop_position.h"

namespace dts::device::sim {

/// A recorded centre of pressure that a simulated person repeats. CSV with the header `t_s,x_mm,y_mm` (x ML, y AP) and strictly
/// increasing times. The mean of all rows is subtracted, because the stance determines the position of the person.
class CopRecording {
 public:
  static constexpr std::size_t kMaxRows = 4'000'000;  ///< More than an hour at 1 kHz.
  static constexpr double kMaxMillimetres = 1000.0;
  /// Duration of the straight line from the end of a repeated recording to its next beginning.
  static constexpr double kBridgeS = 1.0;

  /// Loads a file. Fails with NotFound, or with InvalidArgument, naming "file:line" and the mistake.
  [[nodiscard]] static core::Result<CopRecording> load(const std::string& path);

  [[nodiscard]] double duration_s() const noexcept { return times_s_.back(); }
  /// Returns the position at `time_s`, linear between the rows; before the first and after the last row, that row. Realtime-safe: yes.
  [[nodiscard]] dts::sim::CopPosition at(double time_s) const noexcept;
  /// Returns the position of the endlessly repeated recording. Realtime-safe: yes.
  [[nodiscard]] dts::sim::CopPosition repeated_at(double time_s) const noexcept;

 private:
  CopRecording() = default;
  core::Status append(std::span<const double> row, const std::string& place);
  void subtract_mean() noexcept;

  std::vector<double> times_s_;  ///< Times since the first row.
  std::vector<dts::sim::CopPosition> positions_;
  double first_time_s_ = 0.0;
};

}  // namespace dts::device::sim
