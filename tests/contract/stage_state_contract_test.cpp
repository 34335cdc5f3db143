// SPDX-License-Identifier: Apache-2.0
// What every stage promises about its state: saved anywhere it goes on in a fresh stage, and nonsense out of a file does no harm.
#include "contract/stage_contract.h"

namespace dts::pipeline::contract {
namespace {

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
  std::vector<std::vector<double>> impossible{std::vector<double>(good.size() + 1, 0.0)};
  if (!good.empty()) impossible.emplace_back();
  for (const double value : {kNaN, -1.0, 1e300, -kInfinity, 0.5}) {
    if (!good.empty()) impossible.emplace_back(good.size(), value);
  }

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
  PreparedStage stage(GetParam(), {});  // one for all: restoring leaves nothing of what was before
  for (std::size_t number = 0; number < good.size(); ++number) {
    for (const double value : {kNaN, kInfinity, -kInfinity, -1.0, 0.0, 3.0, 255.0, 256.0, 1e18, 1e300, -1e-300}) {
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

}  // namespace
}  // namespace dts::pipeline::contract
