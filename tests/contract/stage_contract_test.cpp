// SPDX-License-Identifier: Apache-2.0
// What every stage promises (daemon/pipeline/stage.h), for all stages of the registry with synthetic input. A new stage is
// done when it passes here; nothing in this file names one.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "support/allocation_counter.h"
#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/stage_runner.h"
#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {
namespace {

using testing::HasSubstr;

constexpr std::size_t kLargestBlock = 64;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Options = std::map<std::string, OptionValue, std::less<>>;

/// A stage with its surroundings, prepared for the first kind of input that it takes.
class PreparedStage {
 public:
  PreparedStage(const std::string& id, const Options& options) : stage_(surroundings_.make({.id = id, .options = options})) { prepare(); }

  void prepare() {
    for (const auto maker : {&standing_volts, &standing_millimetres}) {
      const auto format = stage_->prepare(maker(0, 1, Faults::None).format, kLargestBlock);
      if (!format) continue;
      make_signal_ = maker;
      format_ = *format;
      return;
    }
    // An option at the end of its range may ask for more than this input has: a marker channel, say.
  }
  [[nodiscard]] bool is_prepared() const { return make_signal_ != nullptr; }
  [[nodiscard]] Signal signal(std::size_t scans, std::uint64_t seed, Faults faults) const { return make_signal_(scans, seed, faults); }
  Output run(const Signal& signal, std::vector<std::size_t> block_sizes = {kLargestBlock}) {
    return pipeline::run(*stage_, format_.channels.size(), signal, block_sizes);
  }
  Stage& operator*() { return *stage_; }
  Stage* operator->() { return stage_.get(); }
  [[nodiscard]] const core::StreamFormat& format() const { return format_; }

 private:
  StageSurroundings surroundings_;
  std::unique_ptr<Stage> stage_;
  Signal (*make_signal_)(std::size_t, std::uint64_t, Faults) = nullptr;
  core::StreamFormat format_;
};

/// Bit by bit; all NaNs are one.
void expect_same(const Output& expected, const Output& actual, const std::string& what) {
  ASSERT_EQ(expected.scan, actual.scan) << what;
  ASSERT_EQ(expected.bits, actual.bits) << what;
  for (std::size_t c = 0; c < expected.values.size(); ++c) {
    for (std::size_t i = 0; i < expected.values[c].size(); ++i) {
      const double a = expected.values[c][i];
      const double b = actual.values[c][i];
      const bool is_same = std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
      ASSERT_TRUE(is_same) << what << ", channel " << c << ", scan " << expected.scan[i] << ": " << a << " and " << b;
    }
  }
}

/// The defaults, and each option once at each end of its range or at each word.
std::vector<Options> option_sets(const StageDescription& description) {
  std::vector<Options> sets{{}};
  for (const OptionDescription& option : description.options) {
    const std::string name(option.name);
    for (const std::string_view word : option.choices) sets.push_back({{name, std::string(word)}});
    if (!option.choices.empty()) continue;
    sets.push_back({{name, option.minimum}});
    sets.push_back({{name, option.maximum}});
  }
  return sets;
}

std::string text_of(const Options& options) {
  std::string text = "options:";
  for (const auto& [name, value] : options) {
    const double* const number = std::get_if<double>(&value);
    text += " " + name + " = " + (number != nullptr ? std::to_string(*number) : std::get<std::string>(value));
  }
  return text;
}

/// [a-z][a-z0-9_]*
bool is_name(std::string_view text) {
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !text.empty() && text[0] >= 'a' && text[0] <= 'z' && std::ranges::all_of(text, is_allowed);
}

bool is_sentence(std::string_view text) { return text.size() > 1 && text.front() != ' ' && text.back() == '.'; }

class StageContract : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] static const StageDescription& description() {
    for (const StageEntry& entry : stage_registry()) {
      if (entry.describe().id == GetParam()) return entry.describe();
    }
    throw std::logic_error("no such stage");
  }
};

TEST_P(StageContract, Description_IsComplete) {
  EXPECT_TRUE(is_name(description().id));
  EXPECT_TRUE(is_name(description().output_stream));
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
  std::multiset<std::string_view> streams;
  for (const StageEntry& entry : stage_registry()) {
    ids.insert(entry.describe().id);
    streams.insert(entry.describe().output_stream);
  }

  EXPECT_EQ(ids.count(GetParam()), 1U);
  EXPECT_EQ(streams.count(description().output_stream), 1U);
  EXPECT_EQ(&PreparedStage(GetParam(), {})->describe(), &description());
}

TEST_P(StageContract, PreparedOutput_NamesItsChannelsAndUnits) {
  const PreparedStage stage(GetParam(), {});

  ASSERT_TRUE(stage.is_prepared()) << "no kind of input of this test suits: add one";
  EXPECT_FALSE(stage.format().channels.empty());
  EXPECT_LE(stage.format().channels.size(), core::kMaxChannels);
  for (const core::ChannelFormat& channel : stage.format().channels) EXPECT_FALSE(channel.name.empty() || channel.unit.empty());
  EXPECT_GE(stage.format().delay_ns, 0);
}

TEST_P(StageContract, BlockSizes_DoNotChangeTheResult) {
  for (const Options& options : option_sets(description())) {
    PreparedStage reference(GetParam(), options);
    if (!reference.is_prepared()) continue;
    const Signal signal = reference.signal(1500, 42, Faults::Some);
    const Output expected = reference.run(signal);
    std::mt19937_64 random(4711);
    std::vector<std::vector<std::size_t>> splits{{1}, {3}, {7}, {64}};
    for (int k = 0; k < 4; ++k) {
      splits.emplace_back();
      for (int block = 0; block < 50; ++block) splits.back().push_back(1 + random() % kLargestBlock);
    }
    for (const auto& split : splits) {
      PreparedStage stage(GetParam(), options);
      expect_same(expected, stage.run(signal, split), text_of(options) + ", first blocks " + testing::PrintToString(split.front()));
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(StageContract, HostTime_BelongsToTheFirstScanOfTheBlock) {
  for (const Options& options : option_sets(description())) {
    PreparedStage stage(GetParam(), options);
    if (!stage.is_prepared()) continue;

    const Output output = stage.run(stage.signal(300, 42, Faults::None), {1, 10, 64});

    for (std::size_t block = 0; block < output.block_first_scan.size(); ++block) {
      EXPECT_EQ(output.block_host_time_ns[block], host_time_ns(stage.format().rate, output.block_first_scan[block])) << text_of(options);
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
  PreparedStage stage(GetParam(), {});

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

TEST_P(StageContract, ResetAndPrepare_EqualFresh) {
  for (const Options& options : option_sets(description())) {
    PreparedStage fresh(GetParam(), options);
    if (!fresh.is_prepared()) continue;
    const Signal signal = fresh.signal(700, 3, Faults::Some);
    const Output expected = fresh.run(signal);
    PreparedStage used(GetParam(), options);

    used.run(used.signal(1001, 99, Faults::Some));
    used->reset();
    expect_same(expected, used.run(signal), "after reset, " + text_of(options));
    used.prepare();
    expect_same(expected, used.run(signal), "after prepare, " + text_of(options));
  }
}

/// What `stage` gives for the scans of `signal` from `first` on.
Output run_from(PreparedStage& stage, const Signal& signal, std::size_t first, std::size_t block_size) {
  Signal rest = signal;
  for (std::size_t c = 0; c < signal.values.size(); ++c) {
    rest.values[c].erase(rest.values[c].begin(), rest.values[c].begin() + static_cast<std::ptrdiff_t>(first));
    rest.bits[c].erase(rest.bits[c].begin(), rest.bits[c].begin() + static_cast<std::ptrdiff_t>(first));
  }
  rest.first_scan = signal.first_scan + first;
  return stage.run(rest, {block_size});
}

Signal first_of(Signal signal, std::size_t scans) {
  for (auto& column : signal.values) column.resize(scans);
  for (auto& column : signal.bits) column.resize(scans);
  return signal;
}

std::vector<double> saved(Stage& stage) {
  std::vector<double> state(stage.state_size(), 12345.0);
  stage.save(state);
  return state;
}

TEST_P(StageContract, StateSavedAnywhere_GoesOnInAFreshStageBitForBit) {
  for (const Options& options : option_sets(description())) {
    if (!PreparedStage(GetParam(), options).is_prepared()) continue;
    const Signal signal = PreparedStage(GetParam(), options).signal(500, 21, Faults::Some);
    const bool is_default = options.empty();  // the others only twice: calibrating an estimator takes its time
    for (const std::size_t scans :
         is_default ? std::vector<std::size_t>{0, 1, 2, 3, 50, 99, 137, 300, 499} : std::vector<std::size_t>{3, 137}) {
      SCOPED_TRACE(text_of(options) + ", saved before scan " + std::to_string(scans));
      PreparedStage original(GetParam(), options);
      original.run(original.signal(150, 77, Faults::Some));  // a segment before, which must leave no trace
      original->reset();
      original.run(first_of(signal, scans), {7});
      const std::vector<double> state = saved(*original);
      PreparedStage fresh(GetParam(), options);

      ASSERT_TRUE(fresh->restore(state));

      expect_same(run_from(original, signal, scans, 11), run_from(fresh, signal, scans, 64), "after restore");
      if (HasFatalFailure()) return;
      // What is behind it comes along too: both go on alike in the next segment.
      original->reset();
      fresh->reset();
      expect_same(original.run(first_of(signal, 200)), fresh.run(first_of(signal, 200)), "after the next reset");
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(StageContract, ImpossibleState_IsRefusedAndLeavesAFreshStage) {
  PreparedStage fresh(GetParam(), {});
  const Signal signal = fresh.signal(400, 3, Faults::Some);
  const Output expected = fresh.run(signal);
  PreparedStage used(GetParam(), {});
  used.run(signal);
  const std::vector<double> good = saved(*used);
  std::vector<std::vector<double>> impossible{{}, std::vector<double>(good.size() + 1, 0.0)};
  for (const double value : {kNaN, -1.0, 1e300, -kInfinity, 0.5}) impossible.emplace_back(good.size(), value);

  for (const std::vector<double>& state : impossible) {
    PreparedStage stage(GetParam(), {});
    stage.run(signal);
    EXPECT_FALSE(stage->restore(state)) << testing::PrintToString(state);
    expect_same(expected, stage.run(signal), "after an impossible state");
  }
}

/// Every number of a good state replaced by every kind of nonsense: taken or not, the stage goes on and keeps its promises.
TEST_P(StageContract, DamagedState_NeverGivesAnUnexplainedValue) {
  PreparedStage used(GetParam(), {});
  const Signal signal = used.signal(60, 3, Faults::None);
  used.run(signal);
  const std::vector<double> good = saved(*used);
  for (std::size_t number = 0; number < good.size(); ++number) {
    for (const double value : {kNaN, kInfinity, -kInfinity, -1.0, 0.0, 3.0, 255.0, 256.0, 1e18, 1e300, -1e-300}) {
      PreparedStage stage(GetParam(), {});
      std::vector<double> state = good;
      state[number] = value;
      (void)stage->restore(state);
      const Output output = stage.run(signal);
      for (std::size_t c = 0; c < output.values.size(); ++c) {
        for (std::size_t i = 0; i < output.values[c].size(); ++i) {
          ASSERT_TRUE(std::isfinite(output.values[c][i]) || output.bits[c][i] != 0) << "number " << number << " = " << value;
        }
      }
    }
  }
}

TEST_P(StageContract, SaveIsDeterministic_AndSaysNothingOfABlocksSize) {
  for (const Options& options : option_sets(description())) {
    PreparedStage one(GetParam(), options);
    PreparedStage other(GetParam(), options);
    if (!one.is_prepared()) continue;
    const Signal signal = one.signal(333, 9, Faults::Some);
    one.run(signal, {64});
    other.run(other.signal(100, 1, Faults::None));
    other.prepare();
    other.run(signal, {1, 5, 13});

    const std::vector<double> state = saved(*one);
    const std::vector<double> same = saved(*other);

    ASSERT_EQ(state.size(), same.size());
    for (std::size_t number = 0; number < state.size(); ++number) {
      const bool is_same = std::isnan(state[number]) ? std::isnan(same[number]) : state[number] == same[number];
      ASSERT_TRUE(is_same) << text_of(options) << ", number " << number << ": " << state[number] << " and " << same[number];
    }
  }
}

TEST_P(StageContract, ProcessAndReset_DoNotTouchTheHeap) {
  PreparedStage stage(GetParam(), {});
  const Signal signal = stage.signal(640, 11, Faults::Some);
  core::Block in(signal.values.size(), kLargestBlock);
  core::Block out(stage.format().channels.size(), kLargestBlock);
  std::vector<double> state(stage->state_size());

  const std::uint64_t before = test::heap_calls_of_this_thread();
  for (std::size_t first = 0; first < signal.scans(); first += kLargestBlock) {
    fill_block(signal, first, kLargestBlock, in);
    out.copy_position(in);
    stage->process(in, out);
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
}  // namespace dts::pipeline
