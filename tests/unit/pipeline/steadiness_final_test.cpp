// SPDX-License-Identifier: Apache-2.0
// Running values against those of the final analysis: the same formulas, a causal low-pass here and a zero-phase one there.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "posturography/analysis.h"
#include "unit/pipeline/standing_cop.h"

namespace dts::pipeline {
namespace {

using posturography::Measure;

/// A trial within a recording: somebody stands a second before it and after it, too.
struct Trial {
  explicit Trial(const Signal& signal)
      : first(static_cast<std::size_t>(signal.format.rate.hz())), end(signal.scans() - static_cast<std::size_t>(signal.format.rate.hz())) {}

  std::size_t first;
  std::size_t end;
};

core::RunningSway running_values(const Signal& signal) {
  StageSurroundings surroundings;
  const auto stage = surroundings.make({.id = "steadiness", .options = {{"settle_ms", 60'000.0}}});
  const Trial trial(signal);
  surroundings.windows.open(1, 0, {trial.first}, {trial.end});
  const std::size_t block = 20;
  EXPECT_TRUE(stage->prepare(signal.format, block));
  core::RunningSway last;
  for (const core::SwayEvent& event : run(*stage, 0, signal, std::span(&block, 1)).sways) {
    if (event.trial == 1) last = event.values;  // after the trial another window may begin
  }
  return last;
}

/// Of the trial alone, as the daemon does it at its end.
posturography::Analysis final_values(const Signal& signal) {
  const Trial trial(signal);
  const auto part = [&](std::size_t channel) {
    const auto begin = signal.values[channel].begin();
    return std::vector<double>(begin + static_cast<std::ptrdiff_t>(trial.first), begin + static_cast<std::ptrdiff_t>(trial.end));
  };
  return posturography::analyse({.rate_hz = signal.format.rate.hz(), .ml_mm = part(0), .ap_mm = part(1)},
                                {.preparation = posturography::kReportPreparation})
      .value();
}

/// Shares of one.
struct Tolerances {
  double path;
  double moments;
};

class Comparison {
 public:
  explicit Comparison(const Signal& signal) : running_(running_values(signal)), final_(final_values(signal)) {}

  void expect_within(const Tolerances& tolerances) {
    ASSERT_EQ(running_.samples, final_.samples);
    ASSERT_EQ(running_.rate_hz, final_.rate_hz);
    const double duration_s = static_cast<double>(running_.samples) / running_.rate_hz;
    expect(Measure::Totex, running_.totex_mm, tolerances.path);
    expect(Measure::TotexAp, running_.totex_ap_mm, tolerances.path);
    expect(Measure::TotexMl, running_.totex_ml_mm, tolerances.path);
    expect(Measure::Mvelo, running_.totex_mm / duration_s, tolerances.path);
    expect(Measure::MveloAp, running_.totex_ap_mm / duration_s, tolerances.path);
    expect(Measure::MveloMl, running_.totex_ml_mm / duration_s, tolerances.path);
    expect(Measure::Rdist, running_.rdist_mm, tolerances.moments);
    expect(Measure::RdistAp, running_.rdist_ap_mm, tolerances.moments);
    expect(Measure::RdistMl, running_.rdist_ml_mm, tolerances.moments);
    expect(Measure::EllSd1, running_.ellipse_sd1_mm, tolerances.moments);
    expect(Measure::EllSd2, running_.ellipse_sd2_mm, tolerances.moments);
    expect(Measure::Pea95F, running_.pea95_f_mm2, tolerances.moments);
  }

 private:
  void expect(Measure measure, double running, double tolerance) {
    const std::string symbol(posturography::info(measure).symbol);
    ASSERT_TRUE(final_.measures.has(measure)) << symbol;
    const double expected = *final_.measures.get(measure);
    const double off = running / expected - 1.0;
    EXPECT_LE(std::abs(off), tolerance) << symbol << ": running " << running << ", final " << expected;
    testing::Test::RecordProperty(symbol + "_off_percent", std::to_string(100.0 * off));
  }

  core::RunningSway running_;
  posturography::Analysis final_;
};

/// Columns t_s, x_mm (ML), y_mm (AP); nothing when the shared data are not here.
std::optional<Signal> recording(const std::string& name, double hz) {
  std::ifstream file(std::filesystem::path(DTS_SOURCE_DIR) / "../shared/data/cop" / name);
  if (!file) return std::nullopt;
  std::vector<std::vector<double>> columns(3);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream row(line);
    double value = 0.0;
    char comma = 0;
    row >> value >> comma >> value;
    columns[0].push_back(value);
    row >> comma >> value;
    columns[1].push_back(value);
    columns[2].push_back(700.0);
  }
  Signal signal = swaying_cop(hz, 0, 1);
  signal.values = columns;
  for (auto& bits : signal.bits) bits.resize(columns[0].size());
  return signal;
}

/// With a second of its point reflection before it and after it, which is what the zero-phase filter sees there.
Signal continued(const Signal& signal) {
  const auto scans = static_cast<std::ptrdiff_t>(signal.format.rate.hz());
  Signal longer = signal;
  for (auto& column : longer.values) {
    const std::vector<double> inner = column;
    column.clear();
    for (std::ptrdiff_t i = scans; i > 0; --i) column.push_back(2.0 * inner.front() - *(inner.begin() + i));
    column.insert(column.end(), inner.begin(), inner.end());
    for (std::ptrdiff_t i = 1; i <= scans; ++i) column.push_back(2.0 * inner.back() - *(inner.end() - 1 - i));
  }
  for (auto& bits : longer.bits) bits.resize(longer.scans());
  return longer;
}

TEST(SteadinessAndFinal, RecordingsOfPeopleOrAllOfThem_AreNearTheFinalValues) {
  struct Recording {
    const char* name;
    double hz;
  };
  for (const auto& [name, hz] : {Recording{"d01_bds00073_young_eo_firm.csv", 100.0},
                                 {"d02_bds00079_young_ec_firm.csv", 100.0},
                                 {"d03_acuna_eo2_1000hz.csv", 1000.0}}) {
    SCOPED_TRACE(name);
    const auto signal = recording(name, hz);
    if (!signal) GTEST_SKIP() << "shared data are not here: " << name;
    Comparison(*signal).expect_within({.path = 0.005, .moments = 0.001});
    Comparison(continued(*signal)).expect_within({.path = 0.005, .moments = 0.001});
  }
}

TEST(SteadinessAndFinal, SyntheticSway_IsNearTheFinalValues) {
  RecordProperty("requirement", "SWAY-8");
  for (const double hz : {100.0, 400.0, 1000.0}) {
    SCOPED_TRACE(hz);
    Comparison(swaying_cop(hz, static_cast<std::size_t>(60.0 * hz), 11)).expect_within({.path = 0.005, .moments = 0.001});
  }
}

}  // namespace
}  // namespace dts::pipeline
