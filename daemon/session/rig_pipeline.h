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
#include "pipeline/tare.h"
#include "record/recorder.h"

namespace dts::session {

/// The pipeline of a rig with the letter boxes that its stages refer to, which therefore live longer.
struct RigPipeline {
  std::unique_ptr<pipeline::Tare> tare;
  std::unique_ptr<pipeline::SteadinessWindows> windows;
  std::unique_ptr<pipeline::Pipeline> pipeline;
};

/// Assembles what `config` describes for the channels of `device`; `config.rate` is the device's exact rate. One place for daemon and
/// laboratory: a replay that assembled anything else would prove nothing. The stages refer into `config.model` and
/// `config.cop_calibration`: `config` stays where it is and outlives the pipeline. Fails with InvalidArgument, naming the rig.
[[nodiscard]] core::Result<RigPipeline> make_rig_pipeline(const pipeline::RigConfig& config, const device::DeviceDescription& device);

/// Whether the pipeline went on from where a recording began.
enum class Restored : std::uint8_t {
  NoRecording,  ///< The device plays none, or one without the state of its stages: nothing to restore.
  OtherStages,  ///< The recording was made by other stages or with other options: their state means nothing here.
  Done,         ///< The next block continues the recorded stream.
};

/// Takes up the state that the device's recording holds, so that its replay gives what was recorded bit for bit from the first scan on.
/// Before the pipeline's first block, which comes at `next_scan` of `segment`; acquisition lets a replay begin at the recorded index. Fails
/// with DataDamaged, naming the stage, when the state is impossible; the pipeline is then as fresh.
[[nodiscard]] core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device,
                                                      std::uint32_t segment, core::ScanIndex next_scan);
[[nodiscard]] core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device);

/// What is recorded of a rig: the streams that its configuration names, or all; "raw" and "aux" always, since everything else can be
/// computed from them again. They keep every bit that the device gave, what was computed stands as it is published.
[[nodiscard]] std::vector<record::RecordedStream> recorded_streams(const pipeline::RigConfig& config,
                                                                   const device::DeviceDescription& device,
                                                                   std::span<const core::StreamFormat> formats);

}  // namespace dts::session
