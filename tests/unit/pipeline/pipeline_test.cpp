// SPDX-License-Identifier: Apache-2.0
#include "pipeline/pipeline.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "unit/pipeline/floor_rig.h"

namespace dts::pipeline {
namespace {

using core::quality::kOutOfRange;
using core::quality::kRotation;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;

const std::vector<StageConfig> kFloorStages{{"guard", {}}, {"window_filter", {}}, {"linearise", {}}, {"cop", {}}};

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
  }
  [[nodiscard]] core::Error error_of(const std::vector<StageConfig>& stages, const PipelineInput& input = six_channels()) {
    const auto pipeline = Pipeline::create(stages, input, surroundings_.context());
    return pipeline ? core::Error{} : pipeline.error();
  }
  /// The next scans of the device; channel c of scan i reads i + c / 8 volts.
  core::Acquired next(std::size_t scans) {
    core::Acquired acquired{.block = core::Block(6, 16), .gap_before = {}, .lost_scans_total = 0};
    acquired.block.set_count(scans);
    acquired.block.segment = segment_;
    acquired.block.first_scan = core::ScanIndex{scan_};
    acquired.block.host_time_ns = static_cast<std::int64_t>(1'000'000'000 + scan_ * 10'000'000);
    for (std::size_t c = 0; c < 6; ++c) {
      for (std::size_t i = 0; i < scans; ++i) {
        acquired.block.column(c)[i] = static_cast<double>(scan_ + i) + static_cast<double>(c) / 8;
      }
    }
    scan_ += scans;
    return acquired;
  }
  [[nodiscard]] std::vector<std::size_t> counts() const {
    std::vector<std::size_t> result;
    for (const core::Block& block : frame_.streams) result.push_back(block.count());
    return result;
  }

  StageSurroundings surroundings_;
  std::unique_ptr<Pipeline> pipeline_;
  core::Frame frame_;
  std::uint32_t segment_ = 0;
  std::uint64_t scan_ = 0;
};

TEST_F(PipelineTest, TriggerChannel_GivesItsEdgesWithTheFrame) {
  PipelineInput input = six_channels();
  input.trigger = TriggerInput{.channel = 0, .level = 2.2, .hysteresis = 0.0};  // the second auxiliary reads its scan
  create(kFloorStages, input);

  pipeline_->process(next(2), frame_);
  EXPECT_EQ(pipeline_->events().triggers.count, 0U);
  pipeline_->process(next(2), frame_);
  ASSERT_EQ(pipeline_->events().triggers.count, 1U);
  EXPECT_EQ(pipeline_->events().triggers.events[0].scan.value, 3U);
  EXPECT_EQ(pipeline_->events().triggers.events[0].host_time_ns, 1'030'000'000);
  pipeline_->process(next(2), frame_);
  EXPECT_EQ(pipeline_->events().triggers.count, 0U);
}

TEST_F(PipelineTest, Formats_AreTheStagesStreamsThenAux) {
  create(kFloorStages);

  std::vector<std::string> names;
  for (const core::StreamFormat& format : pipeline_->formats()) names.push_back(format.name);
  EXPECT_THAT(names, ElementsAre("raw", "filtered", "deflection", "cop", "aux"));
  EXPECT_EQ(pipeline_->formats()[0].channels[0], (core::ChannelFormat{"w1_v", "V"}));
  EXPECT_EQ(pipeline_->formats()[0].channels.size(), 4U);
  EXPECT_EQ(pipeline_->formats()[1].channels[3], (core::ChannelFormat{"w4_v", "V"}));
  EXPECT_EQ(pipeline_->formats()[2].channels[0], (core::ChannelFormat{"w1_mm", "mm"}));
  EXPECT_EQ(pipeline_->formats()[3].delay_ns, 10'000'000);
  EXPECT_EQ(pipeline_->formats()[4].channels, six_channels().aux_formats);
}

TEST_F(PipelineTest, NoAuxChannels_MakeNoAuxStream) {
  PipelineInput input = six_channels();
  input.aux_channels.clear();
  input.aux_formats.clear();

  create(kFloorStages, input);

  EXPECT_EQ(pipeline_->formats().size(), 4U);
  EXPECT_EQ(frame_.streams.size(), 4U);
}

TEST_F(PipelineTest, Block_IsSplitIntoSensorsAndAuxByChannel) {
  create(kFloorStages);

  pipeline_->process(next(2), frame_);

  EXPECT_THAT(frame_.streams[0].column(0), ElementsAre(0.5, 1.5));  // device channel 4
  EXPECT_THAT(frame_.streams[0].column(1), ElementsAre(0.125, 1.125));
  EXPECT_THAT(frame_.streams[4].column(0), ElementsAre(0.625, 1.625));
  EXPECT_THAT(frame_.streams[4].column(1), ElementsAre(0.0, 1.0));
}

TEST_F(PipelineTest, Frame_CarriesWhatTheDeviceSaid) {
  create(kFloorStages);
  pipeline_->process(next(5), frame_);
  core::Acquired acquired = next(5);
  acquired.lost_scans_total = 17;

  pipeline_->process(acquired, frame_);

  EXPECT_EQ(frame_.gap_before.reason, core::GapReason::None);
  EXPECT_EQ(frame_.segment, 0U);
  EXPECT_EQ(frame_.host_time_ns, 1'050'000'000);
  EXPECT_EQ(frame_.lost_scans_total, 17U);
  for (const core::Block& block : frame_.streams) {
    EXPECT_EQ(block.first_scan.value, 5U);
    EXPECT_EQ(block.host_time_ns, 1'050'000'000);
  }
}

TEST_F(PipelineTest, WindowNotYetFull_GivesEmptyBlocksThatDoNotCount) {
  create(kFloorStages);

  pipeline_->process(next(2), frame_);
  const auto first_counts = counts();
  pipeline_->process(next(2), frame_);

  EXPECT_THAT(first_counts, ElementsAre(2, 0, 0, 0, 2));
  EXPECT_THAT(counts(), ElementsAre(2, 2, 2, 2, 2));
  EXPECT_EQ(frame_.streams[0].sequence, 1U);
  EXPECT_EQ(frame_.streams[3].sequence, 0U);
  EXPECT_EQ(frame_.streams[3].first_scan.value, 2U);
}

TEST_F(PipelineTest, Gap_ResetsTheStagesAndIsPassedOn) {
  create(kFloorStages);
  pipeline_->process(next(5), frame_);
  segment_ = 1;
  scan_ = 0;
  core::Acquired acquired = next(4);
  acquired.gap_before = {.reason = core::GapReason::Unplugged, .missing_scans = 250, .is_exact = false};

  pipeline_->process(acquired, frame_);

  EXPECT_EQ(frame_.gap_before.reason, core::GapReason::Unplugged);
  EXPECT_EQ(frame_.gap_before.missing_scans, 250U);
  EXPECT_EQ(frame_.segment, 1U);
  EXPECT_THAT(counts(), ElementsAre(4, 2, 2, 2, 4));  // the window fills anew
  EXPECT_EQ(frame_.streams[1].segment, 1U);
  EXPECT_EQ(frame_.streams[1].sequence, 1U);
}

TEST_F(PipelineTest, EmptyBlockWithAGap_PassesTheGapOn) {
  create(kFloorStages);
  pipeline_->process(next(5), frame_);
  core::Acquired lost{.block = core::Block(6, 16), .gap_before = {.reason = core::GapReason::Silence}, .lost_scans_total = 3};
  lost.block.segment = 1;

  pipeline_->process(lost, frame_);

  EXPECT_EQ(frame_.gap_before.reason, core::GapReason::Silence);
  EXPECT_EQ(frame_.segment, 1U);
  EXPECT_EQ(frame_.lost_scans_total, 3U);
  EXPECT_THAT(counts(), Each(0));
}

TEST_F(PipelineTest, EmptyBlockWithoutAGap_ChangesNothing) {
  create(kFloorStages);
  pipeline_->process(next(5), frame_);

  pipeline_->process({.block = core::Block(6, 16), .gap_before = {}, .lost_scans_total = 0}, frame_);
  const auto empty_counts = counts();
  pipeline_->process(next(1), frame_);

  EXPECT_THAT(empty_counts, Each(0));
  EXPECT_THAT(counts(), ElementsAre(1, 1, 1, 1, 1));  // the window is still full
}

TEST_F(PipelineTest, WindowFillsAnewAfterWhateverIsMissing) {
  enum class After { GapWithoutANewSegment, MissingScans, RejectedBlock };
  for (const After after : {After::GapWithoutANewSegment, After::MissingScans, After::RejectedBlock}) {
    create(kFloorStages);
    pipeline_->process(next(5), frame_);
    if (after == After::MissingScans) scan_ += 7;
    if (after == After::RejectedBlock) {
      core::Acquired bad = next(5);
      bad.block = core::Block(2, 16);
      bad.block.set_count(5);
      pipeline_->process(bad, frame_);
    }
    core::Acquired acquired = next(4);
    if (after == After::GapWithoutANewSegment) acquired.gap_before.reason = core::GapReason::Integrity;

    pipeline_->process(acquired, frame_);

    EXPECT_THAT(counts(), ElementsAre(4, 2, 2, 2, 4)) << static_cast<int>(after);
  }
}

TEST_F(PipelineTest, BadBlocks_AreRejectedAndCounted) {
  create(kFloorStages);
  core::Acquired few_channels = next(4);
  few_channels.block = core::Block(5, 16);  // channel 5 is an aux channel
  few_channels.block.set_count(4);
  core::Acquired too_long{.block = core::Block(6, 17), .gap_before = {.reason = core::GapReason::Overrun}, .lost_scans_total = 0};
  too_long.block.set_count(17);

  for (const core::Acquired* bad : {&few_channels, &too_long}) {
    pipeline_->process(*bad, frame_);
    EXPECT_THAT(counts(), Each(0));
    EXPECT_EQ(frame_.gap_before.reason, bad->gap_before.reason);
  }

  EXPECT_EQ(pipeline_->rejected_blocks(), 2U);
}

TEST_F(PipelineTest, AuxValueThatIsNotFinite_IsMarked) {
  create(kFloorStages);
  core::Acquired acquired = next(2);
  acquired.block.column(0)[1] = std::numeric_limits<double>::quiet_NaN();

  pipeline_->process(acquired, frame_);

  EXPECT_THAT(frame_.streams[4].quality(0), Each(0));
  EXPECT_THAT(frame_.streams[4].quality(1), ElementsAre(0, kOutOfRange));
}

TEST_F(PipelineTest, MarkerOfTheGuard_IsAnAuxChannel) {
  create({{"guard", {{"marker_channel", 1.0}, {"marker_v", 0.0}, {"marker_tolerance_v", 1.5}}}});  // device channel 0: 0, 1, 2

  pipeline_->process(next(3), frame_);

  for (std::size_t c = 0; c < 4; ++c) EXPECT_THAT(frame_.streams[0].quality(c), ElementsAre(0, 0, kRotation)) << c;
}

TEST_F(PipelineTest, CreateWithBadStages_IsRefused) {
  const std::vector<std::pair<std::vector<StageConfig>, const char*>> rows{
      {{}, "no stages"},
      {{{"window_filter", {}}}, "'window_filter', which makes stream 'filtered'; it must make 'raw'"},
      {{{"guard", {}}, {"window_filter", {}}, {"window_filter", {}}}, "'filtered', which exists already"},
      {{{"guard", {}}, {"window_filter", {{"window_scan", 3.0}}}}, "did you mean 'window_scans'?"},
      {{{"guard", {}}, {"cop", {}}}, "stage cop: channel 'w1_v' is in 'V', not in 'mm'"}};
  for (const auto& [stages, what] : rows) EXPECT_THAT(error_of(stages).what, HasSubstr(what));
}

TEST_F(PipelineTest, CreateWithBadChannels_IsRefused) {
  const std::vector<std::pair<void (*)(PipelineInput&), const char*>> rows{
      {[](PipelineInput& input) {
         input.sensor_channels = {0, 1, 2};
       },
       "4 sensors, but 3 device channels"},
      {[](PipelineInput& input) {
         input.sensor_channels = {4, 1, 2, 5};
       },
       "device channel 5 is used twice"},
      {[](PipelineInput& input) {
         input.sensor_channels = {4, 1, 2, 32};
       },
       "device channel 32 is above"},
      {[](PipelineInput& input) { input.aux_formats.pop_back(); }, "2 aux channels, but 1 formats"},
      {[](PipelineInput& input) { input.max_block_scans = 0; }, "stage guard: blocks of 0 scans"},
      {[](PipelineInput& input) { input.max_block_scans = core::kMaxBlockScans + 1; }, "stage guard: blocks of"},
      {[](PipelineInput& input) { input.trigger = TriggerInput{.channel = 4}; }, "trigger channel 4"},
      {[](PipelineInput& input) { input.trigger = TriggerInput{.channel = 17}; }, "trigger channel 17"}};
  for (const auto& [change, what] : rows) {
    PipelineInput input = six_channels();
    change(input);
    EXPECT_THAT(error_of(kFloorStages, input).what, HasSubstr(what));
  }
}

}  // namespace
}  // namespace dts::pipeline
