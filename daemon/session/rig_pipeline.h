// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/result.h"
#include "device/device.h"
#include "pipeline/pipeline.h"
#include "pipeline/rig_config.h"
#include "pipeline/steadiness_window.h"
#include "pipeline/subject_stance.h"
#include "pipeline/tare.h"
#include "record/recorder.h"

namespace dts::session {

/// A rig's pipeline, with the exchange objects that its stages refer to and that must outlive it.
struct RigPipeline {
  std::unique_ptr<pipeline::Tare> tare;
  std::unique_ptr<pipeline::SteadinessWindows> windows;
  std::unique_ptr<pipeline::SubjectStances> stances;
  std::unique_ptr<pipeline::Pipeline> pipeline;
};

/// Builds the pipeline that `config` describes for the channels of `device`; `config.rate` is the device's exact rate. Used by daemon and
/// laboratory alike, so that a replay uses the same pipeline. The stages refer to `config.model` and `config.cop_calibration`: `config`
/// must not move and must outlive the pipeline. Fails with InvalidArgument, naming the rig.
[[nodiscard]] core::Result<RigPipeline> make_rig_pipeline(const pipeline::RigConfig& config, const device::DeviceDescription& device);

/// Whether the pipeline continues from the state at the start of a recording.
enum class Restored : std::uint8_t {
  NoRecording,  ///< The device plays no recording, or one without the state of the stages.
  OtherStages,  ///< The recording has other stages or options, so their state cannot be used.
  Done,         ///< The next block continues the recorded stream.
};

/// Restores the state of the stages from the device's recording, so that the replay equals the recording bit for bit from the first scan
/// on. Call it before the pipeline's first block, which must start at `next_scan` of `segment` (acquisition starts a replay at the recorded
/// index). Fails with DataDamaged, naming the stage, if the state is impossible; the pipeline is then in its initial state.
[[nodiscard]] core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device,
                                                      std::uint32_t segment, core::ScanIndex next_scan);
[[nodiscard]] core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device);

/// Returns the streams to record: those in the configuration, or all. Always includes "raw" and "aux", from which all others can be
/// computed again. These two keep every bit of the device's values; the other streams are recorded as published (float32).
[[nodiscard]] std::vector<record::RecordedStream> recorded_streams(const pipeline::RigConfig& config,
                                                                   const device::DeviceDescription& device,
                                                                   std::span<const core::StreamFormat> formats);

}  // namespace dts::session
