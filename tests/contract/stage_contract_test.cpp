// SPDX-License-Identifier: Apache-2.0
// What every stage promises (daemon/pipeline/stage.h), for all stages of the registry with synthetic input. A new stage is
// done when it passes here; nothing in this file names one.
#include "contract/stage_contract.h"

#include <gmock/gmock.h>

#include <random>
#include <set>

#include "support/allocation_counter.h"

namespace dts::pipeline::contract {
namespace {

using testing::HasSubstr;

TEST_P(StageContract, Description_IsComplete) {
  EXPECT_TRUE(is_name(description().id));
  EXPECT_TRUE(description().output_stream.empty() || is_name(description().output_stream));
  EXPECT_TRUE(is_sentence(description().sentence)) << description().sentence;
  std::set<std::string_view> names;
  for (const OptionDescription& option : description().options) {
    SCOPED_TRACE(option.name);
    EXPECT_TRUE(is_name(option.name));
    EXPECT_TRUE(names.insert(option.name).second) << "named twice";
    EXPECT_TRUE(is_sentence(option.sentence)) << option.sentence;
    const std::set<std::string_view> words(option.choices.begin(), option.choices.end());
    EXPECT_EQ(words.size(), option.choices.size()) << "a word twice";
    for (const std::string_view word : words) EXPECT_TRUE(is_name(word)) << word;
    if (!words.empty()) continue;
    EXPECT_LT(option.minimum, option.maximum);
    EXPECT_GE(option.default_value, option.minimum);
    EXPECT_LE(option.default_value, option.maximum);
    EXPECT_TRUE(!option.is_whole || option.default_value == std::round(option.default_value));
  }
}

TEST_P(StageContract, Identity_IsUniqueAndToldByTheStageItself) {
  std::multiset<std::string_view> ids;
  for (const StageEntry& entry : stage_registry()) ids.insert(entry.describe().id);

  EXPECT_EQ(ids.count(GetParam()), 1U);
  EXPECT_EQ(&PreparedStage(GetParam(), {})->describe(), &description());
}

/// What is behind the stream must not need to know which stage made it.
TEST_P(StageContract, StagesOfTheSameStream_MakeTheSameChannels) {
  const PreparedStage stage(GetParam(), {});
  for (const StageEntry& entry : stage_registry()) {
    if (description().output_stream.empty() || entry.describe().output_stream != description().output_stream) continue;
    EXPECT_EQ(PreparedStage(std::string(entry.describe().id), {}).format().channels, stage.format().channels) << entry.describe().id;
  }
}

TEST_P(StageContract, PreparedOutput_NamesItsChannelsAndUnits) {
  const PreparedStage stage(GetParam(), {});

  ASSERT_TRUE(stage.is_prepared()) << "no kind of input of this test suits: add one";
  EXPECT_FALSE(stage.format().channels.empty());
  EXPECT_LE(stage.format().channels.size(), core::kMaxChannels);
  for (const core::ChannelFormat& channel : stage.format().channels) EXPECT_FALSE(channel.name.empty() || channel.unit.empty());
  EXPECT_GE(stage.format().delay_ns, 0);
}

TEST_P(StageContract, BlockSizes_ChangeNeitherResultNorState) {
  RecordProperty("requirement", "SIG-4");
  for (const Options& options : option_sets(description())) {
    PreparedStage stage(GetParam(), options);
    if (!stage.is_prepared()) continue;
    const Signal signal = stage.signal(1000, 42, Faults::Some);
    const Output expected = stage.run(signal);
    const std::vector<double> expected_state = saved(*stage);
    std::mt19937_64 random(4711);
    std::vector<std::vector<std::size_t>> splits{{1}, {7}, std::vector<std::size_t>(50), std::vector<std::size_t>(50)};
    for (std::vector<std::size_t>& split : splits) {
      if (split.size() > 1) std::ranges::generate(split, [&] { return 1 + random() % kLargestBlock; });
      SCOPED_TRACE(text_of(options) + ", first blocks " + testing::PrintToString(split.front()));
      stage->reset();
      const Output output = stage.run(signal, split);
      expect_same(expected, output);
      expect_same(expected_state, saved(*stage));
      for (std::size_t block = 0; block < output.block_first_scan.size(); ++block) {
        ASSERT_EQ(output.block_host_time_ns[block], host_time_ns(stage.format().rate, output.block_first_scan[block]));
      }
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(StageContract, FiniteInputInContact_GivesFiniteOutput) {
  PreparedStage stage(GetParam(), {});

  const Output output = stage.run(stage.signal(3000, 7, Faults::None));

  ASSERT_FALSE(output.scan.empty());
  for (const auto& values : output.values) {
    for (const double value : values) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST_P(StageContract, NotFiniteOutput_IsNaNWithAQualityBit) {
  RecordProperty("requirement", "SIG-5");
  PreparedStage stage(GetParam(), {});
  if (stage.output_channels() == 0) return;  // makes no values

  const Output output = stage.run(stage.signal(3000, 7, Faults::Some));

  std::size_t undefined = 0;
  for (std::size_t c = 0; c < output.values.size(); ++c) {
    for (std::size_t i = 0; i < output.values[c].size(); ++i) {
      ASSERT_FALSE(std::isinf(output.values[c][i]));
      if (!std::isnan(output.values[c][i])) continue;
      ++undefined;
      ASSERT_NE(output.bits[c][i], 0);
    }
  }
  EXPECT_GT(undefined, 0U);
  EXPECT_LT(undefined, output.scan.size() * output.values.size() / 2);  // it recovers
}

TEST_P(StageContract, EventsTold_BelongToTheBlockThatToldThem) {
  PreparedStage stage(GetParam(), {});

  const Output output = stage.run(stage.signal(1500, 21, Faults::Some), {7});

  const auto check = [&](const auto& events) {
    std::uint64_t last = 0;
    for (const auto& event : events) {
      EXPECT_GE(event.scan.value, last);  // in the order of scans
      EXPECT_EQ(event.host_time_ns, host_time_ns(stage.format().rate, event.scan.value));
      last = event.scan.value;
    }
  };
  check(output.reaches);
  check(output.sways);
  // A stage without a stream says something, or the tests of block sizes, reset and state would compare nothing.
  EXPECT_GT(stage.output_channels() + output.reaches.size() + output.classes.size() + output.sways.size(), 0U);
}

TEST_P(StageContract, ResetAndPrepare_EqualFresh) {
  for (const Options& options : option_sets(description())) {
    SCOPED_TRACE(text_of(options));
    PreparedStage stage(GetParam(), options);
    if (!stage.is_prepared()) continue;
    const Signal signal = stage.signal(700, 3, Faults::Some);
    const Output expected = stage.run(signal);
    const std::vector<double> expected_state = saved(*stage);
    for (const bool is_prepared_anew : {false, true}) {
      stage.run(stage.signal(1001, 99, Faults::Some));
      is_prepared_anew ? stage.prepare() : stage->reset();
      expect_same(expected, stage.run(signal));
      expect_same(expected_state, saved(*stage));
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(StageContract, ProcessAndReset_DoNotTouchTheHeap) {
  RecordProperty("requirement", "ACQ-11");
  PreparedStage stage(GetParam(), {});
  const Signal signal = stage.signal(640, 11, Faults::Some);
  core::Block in(signal.values.size(), kLargestBlock);
  core::Block out(stage.output_channels(), kLargestBlock);
  core::FrameEvents events;
  std::vector<double> state(stage->state_size());

  const std::uint64_t before = test::heap_calls_of_this_thread();
  for (std::size_t first = 0; first < signal.scans(); first += kLargestBlock) {
    fill_block(signal, first, kLargestBlock, in);
    out.copy_position(in);
    stage->process(in, out);
    stage->tell(events);
    if (first == 5 * kLargestBlock) stage->reset();
    stage->save(state);
  }
  const std::uint64_t after = test::heap_calls_of_this_thread();

  EXPECT_EQ(after - before, 0U);
  EXPECT_GT(before, 0U);  // the counter counts
}

TEST_P(StageContract, OptionsOutOfRange_AreRefusedByName) {
  StageSurroundings surroundings;
  for (const OptionDescription& option : description().options) {
    if (!option.choices.empty()) continue;
    std::vector<double> bad{std::nextafter(option.minimum, -kInfinity), std::nextafter(option.maximum, kInfinity), kNaN, kInfinity};
    if (option.is_whole) bad.push_back(option.minimum + 0.5);
    for (const double value : bad) {
      const StageConfig config{.id = GetParam(), .options = {{std::string(option.name), value}}};
      const auto stage = create_stage(config, surroundings.context());
      ASSERT_FALSE(stage) << option.name << " = " << value;
      EXPECT_EQ(stage.error().code, core::ErrorCode::InvalidArgument);
      EXPECT_THAT(stage.error().what, HasSubstr("'" + std::string(option.name) + "'"));
    }
  }
}

TEST_P(StageContract, OptionsOfTheWrongTypeOrName_AreRefusedByName) {
  for (const OptionDescription& option : description().options) {
    const std::string name(option.name);
    const OptionValue wrong_type = option.choices.empty() ? OptionValue("many") : OptionValue(1.0);
    const std::vector<std::string> type_problems = check_stage({.id = GetParam(), .options = {{name, wrong_type}}});
    ASSERT_EQ(type_problems.size(), 1U);
    EXPECT_THAT(type_problems[0], HasSubstr("'" + name + "'"));

    const std::vector<std::string> name_problems = check_stage({.id = GetParam(), .options = {{name + "x", 1.0}}});
    ASSERT_EQ(name_problems.size(), 1U);
    EXPECT_THAT(name_problems[0], HasSubstr("did you mean '" + name + "'?"));
    if (option.choices.empty()) continue;
    EXPECT_EQ(check_stage({.id = GetParam(), .options = {{name, "no_such_word"}}}).size(), 1U);
  }
}

TEST_P(StageContract, PrepareSenselessInput_IsRefused) {
  PreparedStage stage(GetParam(), {});
  const core::StreamFormat good = stage.signal(0, 1, Faults::None).format;
  core::StreamFormat no_channels = good;
  no_channels.channels.clear();
  core::StreamFormat too_many = good;
  too_many.channels.resize(core::kMaxChannels + 1, good.channels[0]);

  for (const auto& refused : {stage->prepare(no_channels, 64), stage->prepare(too_many, 64), stage->prepare(good, 0),
                              stage->prepare(good, core::kMaxBlockScans + 1)}) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, core::ErrorCode::InvalidArgument);
    EXPECT_THAT(refused.error().what, HasSubstr("stage " + GetParam()));
  }
  EXPECT_TRUE(stage->prepare(good, 1));
  EXPECT_TRUE(stage->prepare(good, core::kMaxBlockScans));
}

std::vector<std::string> all_stages() {
  std::vector<std::string> ids;
  for (const StageEntry& entry : stage_registry()) ids.emplace_back(entry.describe().id);
  return ids;
}

INSTANTIATE_TEST_SUITE_P(Registry, StageContract, testing::ValuesIn(all_stages()), [](const auto& stage) { return stage.param; });

}  // namespace
}  // namespace dts::pipeline::contract
