// SPDX-License-Identifier: Apache-2.0
// What must hold for whoever stands there: seeded people, every measure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "posturography/analysis.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

constexpr std::size_t kPeople = 3;

Measures measures_of(const CopSeries& series) { return analyse(series, test::kReportOptions).value().measures; }

CopSeries person(std::size_t seed) { return test::standing(seed + 20, 100.0, 3001); }

void expect_near(Measure measure, const Measures& measures, double expected, double relative) {
  const auto value = measures.get(measure);
  ASSERT_TRUE(value) << info(measure).symbol;
  EXPECT_NEAR(*value, expected, relative * std::abs(expected) + 1e-12) << info(measure).symbol;
}

/// Every measure of `after` is that of `before` times `factor_of` it.
template <class FactorOf>
void expect_all(const Measures& before, const Measures& after, FactorOf factor_of) {
  for (std::size_t index = 0; index < kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    ASSERT_EQ(before.has(measure), after.has(measure)) << info(measure).symbol;
    if (before.has(measure)) expect_near(measure, after, *before.get(measure) * factor_of(measure), 1e-9);
  }
}

TEST(AnalysisProperty, Place_DoesNotMatter) {
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const Measures here = measures_of(series);
    for (double& value : series.ml_mm) value += 1000.0;
    for (double& value : series.ap_mm) value -= 250.0;

    expect_all(here, measures_of(series), [](Measure) { return 1.0; });
  }
}

TEST(AnalysisProperty, UnitOfLength_ScalesByThePowerOfTheUnit) {
  constexpr double kScale = 3.7;
  const auto power_of = [](std::string_view unit) {
    return unit.starts_with("mm2") ? 2 : unit.starts_with("mm") ? 1 : unit == "1/mm" ? -1 : 0;
  };
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const Measures before = measures_of(series);
    for (double& value : series.ml_mm) value *= kScale;
    for (double& value : series.ap_mm) value *= kScale;

    expect_all(before, measures_of(series), [&](Measure measure) { return std::pow(kScale, power_of(info(measure).unit)); });
  }
}

TEST(AnalysisProperty, AxesExchanged_ExchangesTheirMeasures) {
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const Measures before = measures_of(series);
    std::swap(series.ml_mm, series.ap_mm);

    const Measures after = measures_of(series);

    for (std::size_t index = 0; index < kMeasureCount; ++index) {
      const auto measure = static_cast<Measure>(index);
      std::string symbol(info(measure).symbol);
      if (const auto ap = symbol.find("_AP"); ap != std::string::npos) {
        symbol.replace(ap, 3, "_ML");
      } else if (const auto ml = symbol.find("_ML"); ml != std::string::npos) {
        symbol.replace(ml, 3, "_AP");
      }
      const auto other = measure_named(symbol);
      if (!other || !before.has(measure)) continue;
      double expected = *before.get(measure);
      if (measure == Measure::EllAngle) expected = expected >= 0.0 ? 90.0 - expected : -90.0 - expected;
      expect_near(*other, after, expected, 1e-9);
    }
  }
}

TEST(AnalysisProperty, FacingElsewhere_TurnsTheEllipseOnly) {
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const Measures before = measures_of(series);
    const double angle_deg = 17.0 + 40.0 * static_cast<double>(seed);
    const double angle = angle_deg * std::numbers::pi / 180.0;
    for (std::size_t i = 0; i < series.ml_mm.size(); ++i) {
      const double ml = series.ml_mm[i];
      const double ap = series.ap_mm[i];
      series.ml_mm[i] = ml * std::cos(angle) - ap * std::sin(angle);
      series.ap_mm[i] = ml * std::sin(angle) + ap * std::cos(angle);
    }

    const Measures after = measures_of(series);

    for (const Measure measure :
         {Measure::Mdist,     Measure::Rdist,   Measure::Totex,   Measure::Mvelo,     Measure::Range,    Measure::Maxdist,
          Measure::AreaCc,    Measure::AreaCe,  Measure::Pea95F,  Measure::Pea95Chi2, Measure::EllSd1,   Measure::EllSd2,
          Measure::AreaHull,  Measure::AreaSw,  Measure::Mfreq,   Measure::FdCc,      Measure::FdCe,     Measure::Lfs,
          Measure::PowerRd,   Measure::CfreqRd, Measure::FreqdRd, Measure::Msd1sRes,  Measure::SdaDsRes, Measure::SdaDlRes,
          Measure::HcMeanabs, Measure::HcSd,    Measure::HcRate}) {
      expect_near(measure, after, *before.get(measure), 1e-8);
    }
    const double turned = *after.get(Measure::EllAngle) - *before.get(Measure::EllAngle) - angle_deg;
    EXPECT_NEAR(std::remainder(turned, 180.0), 0.0, 1e-6);
  }
}

TEST(AnalysisProperty, BackwardsInTime_IsAsSteady) {
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const Measures before = measures_of(series);
    std::reverse(series.ml_mm.begin(), series.ml_mm.end());
    std::reverse(series.ap_mm.begin(), series.ap_mm.end());

    const Measures after = measures_of(series);

    // Filtering forward and backward is not quite the same as backward and forward: the ends are settled in another order.
    for (std::size_t index = 0; index < kMeasureCount; ++index) {
      const auto measure = static_cast<Measure>(index);
      const std::string_view symbol = info(measure).symbol;
      // Entropy counts pairs within a limit, and one more or less is a step; halves of an odd record leave out the last sample.
      if (!before.has(measure) || symbol.starts_with("SAMPEN") || measure == Measure::MpfResWelchhalf) continue;
      expect_near(measure, after, *before.get(measure), symbol.starts_with("SDA") ? 1e-2 : 1e-3);
    }
  }
}

TEST(AnalysisProperty, SameSamplesTwiceAsFast_DoublesVelocitiesAndFrequencies) {
  for (std::size_t seed = 0; seed < kPeople; ++seed) {
    CopSeries series = person(seed);
    const AnalysisOptions as_is{.preparation = {.profile = Profile::AsIs}};
    const Measures slow = analyse(series, as_is).value().measures;
    series.rate_hz *= 2.0;

    const Measures fast = analyse(series, as_is).value().measures;

    for (const Measure measure : {Measure::Mvelo, Measure::MveloAp, Measure::MveloMl, Measure::AreaSw, Measure::Mfreq, Measure::MfreqAp,
                                  Measure::MfreqMl, Measure::VmaxAp, Measure::VmaxMl}) {
      expect_near(measure, fast, 2.0 * *slow.get(measure), 1e-12);
    }
    for (const Measure measure : {Measure::Mdist, Measure::Totex, Measure::Pea95F, Measure::Range, Measure::FdCc, Measure::Lfs}) {
      expect_near(measure, fast, *slow.get(measure), 1e-12);
    }
  }
}

}  // namespace
}  // namespace dts::posturography
