// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "support/committed_text.h"
#include "unit/pipeline/floor_rig.h"

namespace dts::pipeline {
namespace {

/// A device of six channels: the sensors on 4, 1, 2, 3, auxiliaries on 5 and 0.
PipelineInput six_channels() {
  return {.rate = core::Rate::from_hz(100).value(),
          .sensor_channels = {4, 1, 2, 3},
          .aux_channels = {5, 0},
          .aux_formats = {{.name = "emg", .unit = "V"}, {.name = "true_ml", .unit = "mm"}},
          .max_block_scans = 16};
}

class PipelineTest : public testing::Test {
 protected:
  void create(const std::vector<StageConfig>& stages, const PipelineInput& input = six_channels()) {
    pipeline_ = Pipeline::create(stages, input, surroundings_.context()).value();
    frame_ = pipeline_->make_frame();
    text_.precision(12);
  }
  /// The next scans of the device; channel c of scan i reads i + c / 8 volts.
  core::Acquired next(std::size_t scans, core::GapReason gap = core::GapReason::None, std::size_t channels = 6, std::size_t room = 16) {
    core::Acquired acquired{.block = core::Block(channels, room), .gap_before = {}, .lost_scans_total = scan_ / 3};
    acquired.block.set_count(scans);
    acquired.block.segment = segment_;
    acquired.block.first_scan = core::ScanIndex{scan_};
    acquired.block.host_time_ns = static_cast<std::int64_t>(1'000'000'000 + scan_ * 10'000'000);
    acquired.block.clock_drift_ppm = 2.5;
    acquired.block.host_time_uncertainty_ns = 77;
    for (std::size_t c = 0; c < channels; ++c) {
      for (std::size_t i = 0; i < scans; ++i) {
        acquired.block.column(c)[i] = static_cast<double>(scan_ + i) + static_cast<double>(c) / 8;
      }
    }
    if (gap != core::GapReason::None) acquired.gap_before = {.reason = gap, .missing_scans = scan_ + 250, .is_exact = scan_ % 2 == 0};
    scan_ += scans;
    return acquired;
  }
  /// Processes it and writes down the whole frame.
  void step(const std::string& what, const core::Acquired& acquired) {
    pipeline_->process(acquired, frame_);
    text_ << what << ": segment " << frame_.segment << ", " << frame_.host_time_ns << " ns, " << frame_.lost_scans_total << " lost, gap "
          << core::name(frame_.gap_before.reason) << ' ' << frame_.gap_before.missing_scans
          << (frame_.gap_before.is_exact ? " exactly" : "") << ", rejected " << pipeline_->rejected_blocks() << '\n';
    for (std::size_t s = 0; s < frame_.streams.size(); ++s) {
      const core::Block& block = frame_.streams[s];
      text_ << "  " << pipeline_->formats()[s].name << " x " << block.count();
      if (block.count() > 0) {
        text_ << ", number " << block.sequence << ", segment " << block.segment << ", scan " << block.first_scan.value << ", "
              << block.host_time_ns << " +- " << block.host_time_uncertainty_ns << " ns, " << block.clock_drift_ppm << " ppm";
      }
      for (std::size_t c = 0; c < block.channel_count(); ++c) {
        for (std::size_t i = 0; i < block.count(); ++i) {
          text_ << (i == 0 ? " | " : " ") << std::as_const(block).column(c)[i] << ' ' << int{block.quality(c)[i]};
        }
      }
      text_ << '\n';
    }
    for (const core::TriggerEvent& event : pipeline_->events().triggers.all_of()) {
      text_ << "  trigger " << (event.is_rising ? "up" : "down") << " in segment " << event.segment << " at scan " << event.scan.value
            << ", " << event.host_time_ns << " ns\n";
    }
  }
  /// The formats of all streams.
  void describe() {
    for (const core::StreamFormat& format : pipeline_->formats()) {
      text_ << format.name << " at " << format.rate.numerator() << " / " << format.rate.denominator() << " Hz, " << format.delay_ns
            << " ns late:";
      for (const core::ChannelFormat& channel : format.channels) text_ << ' ' << channel.name << " '" << channel.unit << "'";
      text_ << '\n';
    }
  }

  std::ostringstream text_;
  StageSurroundings surroundings_;
  std::unique_ptr<Pipeline> pipeline_;
  core::Frame frame_;
  std::uint32_t segment_ = 0;
  std::uint64_t scan_ = 0;
};

/// What is whole stands in outputs/frames.txt: each block that comes in, and the whole frame that goes out.
TEST_F(PipelineTest, Frames_OfAStoryWithGapsHolesAndBadBlocks) {
  PipelineInput input = six_channels();
  input.trigger = TriggerInput{.channel = 0, .level = 2.2, .hysteresis = 0.0, .edges = TriggerEdges::Both};  // an auxiliary: reads its scan
  create({{"guard", {{"marker_channel", 1.0}, {"marker_v", 5.0}, {"marker_tolerance_v", 5.5}}},
          {"window_filter", {}},
          {"linearise", {}},
          {"cop", {}}},
         input);
  describe();
  step("the window is not full", next(2));
  step("it is, and the trigger rises", next(2));
  step("nothing comes", next(0));
  step("the window is full still", next(1));
  core::Acquired not_finite = next(2);
  not_finite.block.column(0)[1] = std::numeric_limits<double>::quiet_NaN();
  not_finite.block.column(5)[0] = std::numeric_limits<double>::infinity();
  step("an auxiliary is not finite", not_finite);
  scan_ += 7;
  step("seven scans are missing", next(4));
  step("a channel is missing", next(4, core::GapReason::None, 5));
  step("a window fills anew behind a rejected block", next(4));
  step("too many scans", next(17, core::GapReason::Overrun, 6, 17));
  step("a gap without a new segment", next(4, core::GapReason::Integrity));
  segment_ = 1;
  scan_ = 0;
  step("a gap and nothing else", next(0, core::GapReason::Silence));
  step("the new segment", next(4, core::GapReason::Unplugged));
  step("as many as fit", next(16));

  input.aux_channels.clear();
  input.aux_formats.clear();
  input.trigger.reset();
  create({{"guard", {}}, {"window_filter", {}}, {"linearise", {}}, {"cop", {}}}, input);
  describe();
  step("without auxiliaries", next(3));
  dts::test::expect_committed("unit/pipeline/outputs/frames.txt", text_.str(), 1e-9);
}

}  // namespace
}  // namespace dts::pipeline
