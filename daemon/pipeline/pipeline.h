// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/frame.h"
#include "core/result.h"
#include "pipeline/stage.h"
#include "pipeline/stage_registry.h"

namespace dts::pipeline {

/// Which device channels feed the rig.
struct PipelineInput {
  core::Rate rate;
  std::vector<std::size_t> sensor_channels;  ///< Device channel of each sensor of the rig, in sensor order.
  std::vector<std::size_t> aux_channels;     ///< Published beside them as stream "aux".
  std::vector<core::ChannelFormat> aux_formats;
  std::size_t max_block_scans = 64;
};

/// The chain of stages of one rig: device block in, one block per stream out.
///
///     device block --sensors--> guard --raw--> window_filter --filtered--> linearise --deflection--> cop --cop-->
///                  --others---> aux
class Pipeline {
 public:
  /// The first stage must make stream "raw", and no two stages may make the same stream.
  [[nodiscard]] static core::Result<std::unique_ptr<Pipeline>> create(std::span<const StageConfig> stages, const PipelineInput& input,
                                                                      const StageContext& context);

  /// Formats of the streams, in the order of `Frame::streams`.
  [[nodiscard]] std::span<const core::StreamFormat> formats() const noexcept { return formats_; }
  /// A frame with memory for blocks of the largest size; make as many as the rings have slots.
  [[nodiscard]] core::Frame make_frame() const;

  /// Fills `frame` from what the device gave. A gap resets every stage first.
  /// Thread: pipeline. Realtime-safe: yes.
  void process(const core::Acquired& acquired, core::Frame& frame) noexcept;

 private:
  Pipeline() = default;

  PipelineInput input_;
  std::vector<std::unique_ptr<Stage>> stages_;
  std::vector<core::StreamFormat> formats_;
  std::vector<std::uint64_t> sequences_;  ///< Blocks made so far, per stream.
  core::Block sensors_;                   ///< The sensors' columns, in sensor order: input of the first stage.
};

}  // namespace dts::pipeline
