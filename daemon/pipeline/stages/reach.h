// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/reach/reach_machine.h"
#include "pipeline/reach/smoother.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// Finds reaches in the transient and reports P1, P2, P3, d1, d2 (thesis 5.3.3, reach-model section 5): provisional within 60 ms, Final at
/// most 0.65 s after P3. Input: transient_mm, ratio, twist. Makes no stream.
///
/// Points refer to scans of the input, corrected for its delay and that of the smoother. They are the same at every rate, because all
/// windows are durations.
class Reach final : public Stage {
 public:
  Reach(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void tell(core::FrameEvents& events) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  void translate(core::ReachEvent& event, const core::Block& in, std::size_t scan) const noexcept;

  SeatLimits limits_;
  core::Rate rate_;
  std::uint64_t input_delay_scans_ = 0;
  Smoother smoother_;
  ReachMachine machine_;
  ReachMachine::Events events_;  ///< Of the last block.
};

}  // namespace dts::pipeline
