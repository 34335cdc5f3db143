// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <vector>

#include "pipeline/stage.h"

namespace dts::pipeline {

/// Copies the sensors' volts and marks invalid values. Input: one column per sensor of the rig, then the auxiliary channels, which this
/// stage does not pass on; one of them may be the marker.
///
/// kRail        within `rail_codes` codes of an end of the converter's range
/// kStuck       unchanged for longer than `stuck_ms` and 50 scans: even an idle sensor has noise
/// kRotation    on every sensor while the marker is off: the device lost a sample, so the channels are shifted and the
///              COP is a mirror image that looks plausible
/// kOutOfRange  not a finite number; the value becomes NaN
///
/// Keeps the bits that the device has set.
class Guard final : public Stage {
 public:
  Guard(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  struct Sensor {
    double low_rail_v = 0.0;
    double high_rail_v = 0.0;
    double last_v = std::numeric_limits<double>::quiet_NaN();
    std::uint64_t repeats = 0;  ///< Consecutive scans with exactly the previous value.
  };
  void mark_sensor(std::size_t index, const core::Block& in, core::Block& out) noexcept;
  void mark_rotation(std::span<const double> marker, core::Block& out) const noexcept;

  std::vector<StageContext::InputRange> ranges_;
  double rail_codes_;
  double stuck_ms_;
  int marker_channel_;
  double marker_v_;
  double marker_tolerance_v_;
  std::vector<Sensor> sensors_;
  std::uint64_t stuck_limit_ = 0;  ///< More repeats than this mark the sensor as stuck.
};

}  // namespace dts::pipeline
