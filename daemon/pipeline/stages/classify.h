// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pipeline/stage.h"

namespace dts::pipeline {

/// Classifies the trunk movement of every reach as soon as the stage `reach` before it reports its Final: "knowledge of results" (thesis
/// 7.2). Uses the rig's model only; the session adds the scale from a subject's own maximum reaches. Makes no stream and has no state.
class Classify final : public Stage {
 public:
  Classify(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void tell(core::FrameEvents& events) noexcept override;
  void reset() noexcept override {}
  [[nodiscard]] std::size_t state_size() const noexcept override { return 0; }
  void save(std::span<double> state) const noexcept override { static_cast<void>(state); }
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override { return state.empty(); }

 private:
  const classifier::TrunkModel* model_;
};

}  // namespace dts::pipeline
