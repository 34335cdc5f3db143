// SPDX-License-Identifier: Apache-2.0
// What every stage promises about its state: saved anywhere it goes on in a fresh stage, and nonsense out of a file does no harm.
#include "contract/stage_contract.h"

namespace dts::pipeline::contract {
namespace {

TEST_P(StageContract, StateSavedAnywhere_GoesOnInAnotherStageBitForBit) {
  for (const Options& options : option_sets(description())) {
    PreparedStage original(GetParam(), options);
    PreparedStage other(GetParam(), options);  // at first fresh, then used
    if (!other.is_prepared()) continue;
    const Signal signal = original.signal(500, 21, Faults::Some);
    const bool is_default = options.empty();
    for (const std::size_t scans :
         is_default ? std::vector<std::size_t>{0, 1, 2, 3, 50, 99, 137, 300, 499} : std::vector<std::size_t>{3, 137}) {
      SCOPED_TRACE(text_of(options) + ", saved before scan " + std::to_string(scans));
      original.run(original.signal(150, 77, Faults::Some));  // a segment before, which must leave no trace
      original->reset();
      original.run(until(signal, scans), {7});

      ASSERT_TRUE(other->restore(saved(*original)));

      expect_same(original.run(from(signal, scans), {11}), other.run(from(signal, scans), {64}));
      // What is behind it comes along too: both go on alike in the next segment.
      original->reset();
      other->reset();
      expect_same(original.run(until(signal, 200)), other.run(until(signal, 200)));
      original->reset();
      if (HasFatalFailure()) return;
    }
  }
}

TEST_P(StageContract, ImpossibleState_IsRefusedAndLeavesAFreshStage) {
  PreparedStage stage(GetParam(), {});
  const Signal signal = stage.signal(400, 3, Faults::Some);
  const Output expected = stage.run(signal);
  const std::vector<double> good = saved(*stage);
  std::vector<std::vector<double>> impossible{std::vector<double>(good.size() + 1, 0.0)};
  if (!good.empty()) impossible.emplace_back();
  for (const double value : {kNaN, -1.0, 1e300, -kInfinity, 0.5}) {
    if (!good.empty()) impossible.emplace_back(good.size(), value);
  }

  for (const std::vector<double>& state : impossible) {
    EXPECT_FALSE(stage->restore(state)) << testing::PrintToString(state);
    expect_same(expected, stage.run(signal));
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

}  // namespace
}  // namespace dts::pipeline::contract
