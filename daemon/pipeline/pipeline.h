// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/event.h"
#include "core/frame.h"
#include "core/result.h"
#include "pipeline/edge_detector.h"
#include "pipeline/stage.h"
#include "pipeline/stage_registry.h"

namespace dts::pipeline {

/// The device channels that the pipeline of a rig uses.
struct PipelineInput {
  core::Rate rate;
  std::vector<std::size_t> sensor_channels;  ///< Device channel of each input of the rig (`physics::input_names`), in that order.
  std::vector<std::size_t> aux_channels;     ///< Further channels, published as stream "aux"; the guard's marker is one of them.
  std::vector<core::ChannelFormat> aux_formats;
  std::optional<TriggerInput> trigger;  ///< Its channel is one of `aux_channels`.
  std::size_t max_block_scans = 64;
};

/// The chain of stages of one rig: the input is a block from the device, the output one block per stream.
///
///     device block --sensors, aux--> guard --raw--> window_filter --filtered--> linearise --deflection--> cop --cop-->
///                  --aux----------------------------------------------------------------------------------------aux-->
class Pipeline {
 public:
  /// Creates the stages. The first stage must make the stream "raw", and no two stages may make the same stream. Fails with
  /// InvalidArgument, naming the stage, the option or the channel.
  [[nodiscard]] static core::Result<std::unique_ptr<Pipeline>> create(std::span<const StageConfig> stages, const PipelineInput& input,
                                                                      const StageContext& context);

  /// Returns the formats of the streams, in the order of `Frame::streams`: one per stage that makes a stream, then "aux" if there are such
  /// channels.
  [[nodiscard]] std::span<const core::StreamFormat> formats() const noexcept { return formats_; }
  /// Returns a frame with memory for the largest blocks; make one for each slot of the rings.
  [[nodiscard]] core::Frame make_frame() const;

  /// Fills `frame` (made by `make_frame`) from a block of the device. A gap resets every stage first, and so does a block that does not
  /// continue the previous one, so that no window spans missing scans. A block with too few channels or too many scans is rejected: the
  /// frame then has its position but no scans.
  /// Thread: rig. Realtime-safe: yes.
  void process(const core::Acquired& acquired, core::Frame& frame) noexcept;
  /// Returns the events that the trigger and the stages found in the newest block. Thread: rig. Realtime-safe: yes.
  [[nodiscard]] const core::FrameEvents& events() const noexcept { return events_; }

  /// Returns the number of values in the state of the trigger and all stages; fixed after `create`. With this state, a replay can begin in
  /// the middle of a stream.
  [[nodiscard]] std::size_t state_size() const noexcept;
  /// Writes the state before the next block to `state`, which has `state_size()` values. Thread: rig. Realtime-safe: yes.
  void save(std::span<double> state) const noexcept;
  /// Restores a saved state, so that the block at `next_scan` of `segment` continues the stream. Fails with DataDamaged, naming the stage,
  /// if there are too few, too many or impossible values; the pipeline is then in its initial state. Thread: rig, or control before
  /// the rig's thread runs.
  [[nodiscard]] core::Status restore(std::span<const double> state, std::uint32_t segment, core::ScanIndex next_scan);
  /// Returns `stage_text` of every stage, in order.
  [[nodiscard]] const std::vector<std::string>& stage_texts() const noexcept { return stage_texts_; }

  /// Returns the number of rejected blocks. Thread: any. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t rejected_blocks() const noexcept { return rejected_blocks_.load(std::memory_order_relaxed); }

 private:
  Pipeline() = default;

  core::Status watch_trigger(const PipelineInput& input);
  core::Result<core::StreamFormat> append(const StageConfig& config, const core::StreamFormat& input, const StageContext& context);
  [[nodiscard]] bool is_acceptable(const core::Block& block) const noexcept;
  void copy_input(const core::Block& block) noexcept;
  void reset_stages() noexcept;
  [[nodiscard]] std::vector<double> state_of_0_1(std::span<const double> state) const;
  [[nodiscard]] std::string restore_stages(std::span<const double> state);
  void run_stages(core::Frame& frame) noexcept;
  void fill_aux(core::Block& out) const noexcept;

  std::size_t max_block_scans_ = 0;
  std::vector<std::size_t> channels_;  ///< Device channels of the columns of `device_`.
  std::size_t sensor_count_ = 0;
  struct Link {
    std::unique_ptr<Stage> stage;
    std::optional<std::size_t> stream;  ///< Index of its stream in the frame; none: the stage only finds events.
  };
  std::vector<Link> stages_;
  std::vector<std::string> stage_texts_;
  std::vector<core::StreamFormat> formats_;
  bool has_aux_ = false;
  core::Block no_stream_;                 ///< Output block for stages that make no stream.
  std::vector<std::uint64_t> sequences_;  ///< Blocks made so far, per stream.
  std::optional<EdgeDetector> trigger_;
  std::size_t trigger_column_ = 0;  ///< Column of the trigger channel in `device_`.
  core::FrameEvents events_;        ///< Of the newest block.
  core::Block device_;              ///< Input of the first stage: the sensors in their order, then the aux channels.
  std::uint32_t segment_ = 0;
  core::ScanIndex next_scan_;  ///< Index of the scan that continues the segment.
  std::atomic<std::uint64_t> rejected_blocks_{0};
};

}  // namespace dts::pipeline
