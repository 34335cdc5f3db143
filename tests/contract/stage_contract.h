// SPDX-License-Identifier: Apache-2.0
// What the stage contract is checked on and with.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "unit/pipeline/floor_rig.h"
#include "unit/pipeline/reaching_signal.h"
#include "unit/pipeline/stage_runner.h"

#include "unit/pipeline/standing_cop.h"
#include "unit/pipeline/standing_force.h"
#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline::contract {

inline constexpr std::size_t kLargestBlock = 64;
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Options = std::map<std::string, OptionValue, std::less<>>;

/// A stage with its surroundings, prepared for the first kind of input that it takes.
class PreparedStage {
 public:
  PreparedStage(const std::string& id, const Options& options) {
    surroundings_.rig.force_plate = kistler_plate();  // for the stages that need one; the others do not look at it
    stage_ = surroundings_.make({.id = id, .options = options});
    surroundings_.windows.open(1, 0, {10}, {310});  // a trial, for who wants to know
    prepare();
  }

  void prepare() {
    for (const auto maker :
         {&standing_volts, &standing_millimetres, &reaching_transient, &standing_cop, &standing_force_volts, &standing_force}) {
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
    return pipeline::run(*stage_, output_channels(), signal, block_sizes);
  }
  Stage& operator*() { return *stage_; }
  Stage* operator->() { return stage_.get(); }
  [[nodiscard]] const core::StreamFormat& format() const { return format_; }
  /// None of a stage that only watches.
  [[nodiscard]] std::size_t output_channels() const { return stage_->describe().output_stream.empty() ? 0 : format_.channels.size(); }

 private:
  StageSurroundings surroundings_;
  std::unique_ptr<Stage> stage_;
  Signal (*make_signal_)(std::size_t, std::uint64_t, Faults) = nullptr;
  core::StreamFormat format_;
};

/// Bit by bit; all NaNs are one.
inline bool is_same(double a, double b) {
  return std::isnan(a) ? std::isnan(b) : std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

/// All that a reach says, as numbers.
inline std::vector<double> numbers_of(const core::ReachEvent& event) {
  const core::ReachFeatures& of = event.features;
  const auto whole = [](auto value) { return static_cast<double>(value); };
  return {whole(event.step),
          whole(event.number),
          whole(event.segment),
          whole(event.scan.value),
          whole(event.host_time_ns),
          whole(event.p1.scan.value),
          event.p1.value_mm,
          whole(event.p2.scan.value),
          event.p2.value_mm,
          whole(event.p3.scan.value),
          event.p3.value_mm,
          of.p1_mm,
          of.p2_mm,
          of.p3_mm,
          of.hold_mm,
          of.rise_s,
          of.rest_ratio,
          of.ratio_change,
          of.twist,
          of.smoothness,
          whole(event.flags),
          whole(event.resumed)};
}

inline std::vector<double> numbers_of(const core::ClassEvent& event) {
  const core::TrunkMovement& of = event.movement;
  const auto whole = [](auto value) { return static_cast<double>(value); };
  return {whole(event.number),   whole(event.segment), whole(event.scan.value), whole(event.host_time_ns),
          whole(of.trunk_class), of.probability[0],    of.probability[1],       of.probability[2],
          of.trunk_deg,          of.trunk_lo_deg,      of.trunk_hi_deg,         whole(of.reasons)};
}

inline std::vector<double> numbers_of(const core::SwayEvent& event) {
  const core::RunningSway& of = event.values;
  const auto whole = [](auto value) { return static_cast<double>(value); };
  return {whole(event.segment),
          whole(event.scan.value),
          whole(event.host_time_ns),
          whole(event.first_scan.value),
          whole(event.trial),
          whole(of.samples),
          of.rate_hz,
          of.mean_ml_mm,
          of.mean_ap_mm,
          of.rdist_mm,
          of.rdist_ap_mm,
          of.rdist_ml_mm,
          of.totex_mm,
          of.totex_ap_mm,
          of.totex_ml_mm,
          of.range_ap_mm,
          of.range_ml_mm,
          of.ellipse_sd1_mm,
          of.ellipse_sd2_mm,
          of.ellipse_angle_deg,
          of.pea95_f_mm2};
}

inline void expect_same(const std::vector<double>& expected, const std::vector<double>& actual) {
  ASSERT_EQ(expected.size(), actual.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_TRUE(is_same(expected[k], actual[k])) << "number " << k << ": " << expected[k] << " and " << actual[k];
  }
}

template <class Event>
void expect_same_events(const std::vector<Event>& expected, const std::vector<Event>& actual) {
  ASSERT_EQ(expected.size(), actual.size());
  for (std::size_t k = 0; k < expected.size(); ++k) expect_same(numbers_of(expected[k]), numbers_of(actual[k]));
}

inline void expect_same(const Output& expected, const Output& actual) {
  ASSERT_EQ(expected.scan, actual.scan);
  ASSERT_EQ(expected.bits, actual.bits);
  for (std::size_t c = 0; c < expected.values.size(); ++c) expect_same(expected.values[c], actual.values[c]);
  expect_same_events(expected.reaches, actual.reaches);
  expect_same_events(expected.classes, actual.classes);
  expect_same_events(expected.sways, actual.sways);
  ASSERT_EQ(expected.lost_sways + actual.lost_sways, 0U) << "how many find room depends on the size of blocks";
}

/// As many numbers as the stage says, and no more.
inline std::vector<double> saved(const Stage& stage) {
  constexpr double kUntouched = 12345.0;
  std::vector<double> state(stage.state_size() + 8, kUntouched);
  stage.save(state);
  EXPECT_TRUE(std::all_of(state.end() - 8, state.end(), [](double number) { return number == kUntouched; }));
  state.resize(stage.state_size());
  EXPECT_TRUE(state.empty() || state.back() != kUntouched);
  return state;
}

/// The defaults, and each option once at each end of its range or at each word.
inline std::vector<Options> option_sets(const StageDescription& description) {
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

inline std::string text_of(const Options& options) {
  std::string text = "options:";
  for (const auto& [name, value] : options) {
    const double* const number = std::get_if<double>(&value);
    text += " " + name + " = " + (number != nullptr ? std::to_string(*number) : std::get<std::string>(value));
  }
  return text;
}

/// [a-z][a-z0-9_]*
inline bool is_name(std::string_view text) {
  const auto is_allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !text.empty() && text[0] >= 'a' && text[0] <= 'z' && std::ranges::all_of(text, is_allowed);
}

inline bool is_sentence(std::string_view text) { return text.size() > 1 && text.front() != ' ' && text.back() == '.'; }

class StageContract : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] static const StageDescription& description() {
    for (const StageEntry& entry : stage_registry()) {
      if (entry.describe().id == GetParam()) return entry.describe();
    }
    throw std::logic_error("no such stage");
  }
};

}  // namespace dts::pipeline::contract
