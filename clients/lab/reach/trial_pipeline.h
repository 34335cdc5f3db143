// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/rate.h"
#include "core/reach.h"
#include "core/result.h"
#include "physics/rig_model.h"
#include "pipeline/pipeline.h"

namespace dts::lab::reach {

/// The output of the chair's stages for one recording.
struct Watched {
  std::vector<core::ReachEvent> events;
  std::vector<std::pair<double, double>> transient;  ///< s, mm; only where the transient is known.
};

/// The daemon's own stages (guard, linearise, transient, reach) for recordings of one chair at one rate.
class TrialPipeline {
 public:
  /// `rig` must outlive the pipeline.
  [[nodiscard]] static core::Result<std::unique_ptr<TrialPipeline>> create(const physics::RigModel& rig, const core::Rate& rate);
  /// Processes a recording as a new segment: nothing from earlier recordings is used.
  [[nodiscard]] Watched watch(std::span<const std::array<double, 4>> volts);

 private:
  TrialPipeline() = default;
  void process(std::span<const std::array<double, 4>> volts, Watched& watched);

  core::Rate rate_;
  pipeline::Tare tare_;
  pipeline::SteadinessWindows windows_;
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  core::Frame frame_;
  core::Acquired acquired_;
  std::uint32_t segment_ = 0;
  std::uint64_t next_scan_ = 0;
  std::size_t transient_ = 0;  ///< Index of the stream.
};

}  // namespace dts::lab::reach
