// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>

#include "pipeline/pipeline.h"
#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::size_t kBlock = 10;

/// The floor rig's pipeline with a trigger on a fifth channel, which crosses its level every 25 scans.
class Running {
 public:
  explicit Running(double window_scans = 4.0, bool has_steadiness = false) {
    const PipelineInput input{.rate = rate_hz(100),
                              .sensor_channels = {0, 1, 2, 3},
                              .aux_channels = {4},
                              .aux_formats = {{.name = "sync", .unit = "V"}},
                              .trigger = TriggerInput{.channel = 4, .edges = TriggerEdges::Both},
                              .max_block_scans = kBlock};
    std::vector<StageConfig> stages{{"guard", {}}, {"window_filter", {{"window_scans", window_scans}}}, {"linearise", {}}, {"cop", {}}};
    if (has_steadiness) stages.push_back({"steadiness", {}});
    pipeline_ = Pipeline::create(stages, input, surroundings_.context()).value();
    frame_ = pipeline_->make_frame();
  }

  /// Blocks [first, last) of the signal in `segment`: the bits of everything that came out.
  std::vector<std::uint64_t> run(std::size_t first, std::size_t last, std::uint32_t segment = 0) {
    static const Signal signal = standing_volts(600, 5, Faults::Some);
    std::vector<std::uint64_t> out;
    core::Acquired acquired{.block = core::Block(5, kBlock)};
    for (std::size_t block = first; block < last; ++block) {
      acquired.block.segment = segment;
      acquired.block.set_count(kBlock);
      for (std::size_t c = 0; c < 4; ++c) {
        std::copy_n(signal.values[c].begin() + static_cast<std::ptrdiff_t>(block * kBlock), kBlock, acquired.block.column(c).begin());
        std::copy_n(signal.bits[c].begin() + static_cast<std::ptrdiff_t>(block * kBlock), kBlock, acquired.block.quality(c).begin());
      }
      for (std::size_t i = 0; i < kBlock; ++i) acquired.block.column(4)[i] = (block * kBlock + i) / 25 % 2 == 0 ? 0.0 : 5.0;
      acquired.block.first_scan = {block * kBlock};
      pipeline_->process(acquired, frame_);
      note(out);
    }
    return out;
  }
  [[nodiscard]] std::vector<double> save() const {
    std::vector<double> state(pipeline_->state_size());
    pipeline_->save(state);
    return state;
  }
  Pipeline& operator*() { return *pipeline_; }
  Pipeline* operator->() { return pipeline_.get(); }

 private:
  void note(std::vector<std::uint64_t>& out) const {
    out.push_back(pipeline_->events().triggers.count);
    for (const core::Block& block : frame_.streams) {
      out.push_back(block.first_scan.value);
      for (std::size_t c = 0; c < block.channel_count(); ++c) {
        for (const double value : block.column(c)) out.push_back(std::isnan(value) ? 0 : std::bit_cast<std::uint64_t>(value));
        for (const std::uint8_t bits : block.quality(c)) out.push_back(bits);
      }
    }
  }

  StageSurroundings surroundings_;
  std::unique_ptr<Pipeline> pipeline_;
  core::Frame frame_;
};

TEST(PipelineState, RestoredIntoAFreshPipeline_GoesOnBitForBit) {
  for (const std::size_t blocks : {0U, 1U, 3U, 8U, 30U}) {
    Running original;
    original.run(0, blocks, 7);
    Running fresh;

    ASSERT_TRUE(fresh->restore(original.save(), 7, {blocks * kBlock}));

    EXPECT_EQ(original.run(blocks, 60, 7), fresh.run(blocks, 60, 7)) << blocks;
    EXPECT_EQ(original.save().size(), fresh.save().size());
  }
}

TEST(PipelineState, BlockThatDoesNotContinueIt_StartsANewSegment) {
  Running original;
  original.run(0, 30);
  const auto state = original.save();
  for (const auto& [segment, scan] : {std::pair{1U, 300U}, {0U, 310U}}) {
    Running restored;
    ASSERT_TRUE(restored->restore(state, segment, {scan}));
    Running after_gap;
    ASSERT_TRUE(after_gap->restore(state, 9, {0}));

    EXPECT_EQ(restored.run(30, 40), after_gap.run(30, 40)) << "the tare stays, the window does not";
  }
}

TEST(PipelineState, OfDtsd01_LacksTheNewestNumbersOfAStage) {
  constexpr std::size_t kAdded = 6 + 1 + 60 * 19 + 20;  // stage steadiness: load and place of the person, the last 30 s, a void trial
  Running original(4.0, true);
  original.run(0, 30, 7);
  std::vector<double> state = original.save();
  state.resize(state.size() - kAdded);

  Running fresh(4.0, true);
  ASSERT_TRUE(fresh->restore(state, 7, {30 * kBlock}));
  EXPECT_EQ(original.run(30, 60, 7), fresh.run(30, 60, 7)) << "the streams";
  state.pop_back();
  EXPECT_FALSE(Running(4.0, true)->restore(state, 7, {30 * kBlock}));
}

TEST(PipelineState, OfOtherStages_IsRefusedByItsLength) {
  Running original;
  Running other(5.0);

  const auto restored = other->restore(original.save(), 0, {0});

  ASSERT_FALSE(restored);
  EXPECT_EQ(restored.error().code, core::ErrorCode::DataDamaged);
  EXPECT_THAT(restored.error().what,
              HasSubstr(std::to_string(original->state_size()) + " numbers; these stages have " + std::to_string(other->state_size())));
}

TEST(PipelineState, ImpossibleNumber_NamesTheStageAndLeavesAFreshPipeline) {
  Running original;
  original.run(0, 30);
  Running fresh;
  const auto expected = fresh.run(0, 30);
  auto state = original.save();
  state.back() = 2.0;  // contact is yes or no
  Running damaged;

  const auto restored = damaged->restore(state, 0, {300});

  ASSERT_FALSE(restored);
  EXPECT_THAT(restored.error().what, HasSubstr("state of stage cop is not valid"));
  EXPECT_EQ(damaged.run(0, 30), expected);
  state = original.save();
  state.front() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(damaged->restore(state, 0, {300}).error().what, HasSubstr("the trigger"));
}

TEST(PipelineState, StageTexts_HaveEveryOptionExactly) {
  const Running running(3.0);

  EXPECT_EQ(stage_text({.id = "window_filter", .options = {{"window_ms", 0.1 + 0.2}}}),
            "window_filter window_scans=3 window_ms=0.30000000000000004 shift_scans=1");
  EXPECT_EQ(stage_text({.id = "cop", .options = {{"estimator", "thesis"}}}), "cop estimator=thesis contact_threshold_n=50");
  Running other;
  ASSERT_EQ(other->stage_texts().size(), 4U);
  EXPECT_EQ(other->stage_texts()[1], "window_filter window_scans=4 window_ms=0 shift_scans=1");
}

}  // namespace
}  // namespace dts::pipeline
