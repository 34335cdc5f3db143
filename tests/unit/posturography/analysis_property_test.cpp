// SPDX-License-Identifier: Apache-2.0
// What must hold for whoever stands there: seeded people, every measure.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "posturography/analysis.h"
#include "unit/posturography/sway_signals.h"

namespace dts::posturography {
namespace {

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

/// Changes the series of several people and calls `check` with the measures before and after.
template <class Change, class Check>
void change_people(Change change, Check check, const AnalysisOptions& options = test::kReportOptions) {
  for (std::size_t seed = 20; seed < 23; ++seed) {
    SCOPED_TRACE(seed);
    CopSeries series = test::standing(seed, 100.0, 3001);
    const Measures before = analyse(series, options).value().measures;
    change(series);
    check(before, analyse(series, options).value().measures);
  }
}

/// Changes every sample.
template <class Change>
auto each(Change change) {
  return [change](CopSeries& series) {
    for (std::size_t i = 0; i < series.ml_mm.size(); ++i) change(series.ml_mm[i], series.ap_mm[i]);
  };
}

TEST(AnalysisProperty, Place_DoesNotMatter) {
  const auto elsewhere = each([](double& ml_mm, double& ap_mm) {
    ml_mm += 1000.0;
    ap_mm -= 250.0;
  });
  change_people(elsewhere, [](const Measures& here, const Measures& there) { expect_all(here, there, [](Measure) { return 1.0; }); });
}

TEST(AnalysisProperty, UnitOfLength_ScalesByThePowerOfTheUnit) {
  constexpr double kScale = 3.7;
  const auto factor_of = [](Measure measure) {
    const std::string_view unit = info(measure).unit;
    return std::pow(kScale, unit.starts_with("mm2") ? 2 : unit.starts_with("mm") ? 1 : unit == "1/mm" ? -1 : 0);
  };
  const auto scaled = each([](double& ml_mm, double& ap_mm) {
    ml_mm *= kScale;
    ap_mm *= kScale;
  });
  change_people(scaled, [&](const Measures& before, const Measures& after) { expect_all(before, after, factor_of); });
}

TEST(AnalysisProperty, AxesExchanged_ExchangesTheirMeasures) {
  change_people([](CopSeries& series) { std::swap(series.ml_mm, series.ap_mm); },
                [](const Measures& before, const Measures& after) {
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
                });
}

TEST(AnalysisProperty, FacingElsewhere_TurnsTheEllipseOnly) {
  constexpr double kAngleDeg = 57.0;
  const auto turned = each([](double& ml_mm, double& ap_mm) {
    const std::complex<double> place = std::complex(ml_mm, ap_mm) * std::polar(1.0, kAngleDeg * std::numbers::pi / 180.0);
    ml_mm = place.real();
    ap_mm = place.imag();
  });
  change_people(turned, [](const Measures& before, const Measures& after) {
    for (const Measure measure :
         {Measure::Mdist,     Measure::Rdist,   Measure::Totex,   Measure::Mvelo,     Measure::Range,    Measure::Maxdist,
          Measure::AreaCc,    Measure::AreaCe,  Measure::Pea95F,  Measure::Pea95Chi2, Measure::EllSd1,   Measure::EllSd2,
          Measure::AreaHull,  Measure::AreaSw,  Measure::Mfreq,   Measure::FdCc,      Measure::FdCe,     Measure::Lfs,
          Measure::PowerRd,   Measure::CfreqRd, Measure::FreqdRd, Measure::Msd1sRes,  Measure::SdaDsRes, Measure::SdaDlRes,
          Measure::HcMeanabs, Measure::HcSd,    Measure::HcRate}) {
      expect_near(measure, after, *before.get(measure), 1e-8);
    }
    const double change_deg = *after.get(Measure::EllAngle) - *before.get(Measure::EllAngle) - kAngleDeg;
    EXPECT_NEAR(std::remainder(change_deg, 180.0), 0.0, 1e-6);
  });
}

TEST(AnalysisProperty, BackwardsInTime_IsAsSteady) {
  const auto backwards = [](CopSeries& series) {
    std::ranges::reverse(series.ml_mm);
    std::ranges::reverse(series.ap_mm);
  };
  change_people(backwards, [](const Measures& before, const Measures& after) {
    // Filtering forward and backward is not quite the same as backward and forward: the ends are settled in another order.
    for (std::size_t index = 0; index < kMeasureCount; ++index) {
      const auto measure = static_cast<Measure>(index);
      const std::string_view symbol = info(measure).symbol;
      // Entropy counts pairs within a limit, and one more or less is a step; halves of an odd record leave out the last sample.
      if (!before.has(measure) || symbol.starts_with("SAMPEN") || measure == Measure::MpfResWelchhalf) continue;
      expect_near(measure, after, *before.get(measure), symbol.starts_with("SDA") ? 1e-2 : 1e-3);
    }
  });
}

TEST(AnalysisProperty, SameSamplesTwiceAsFast_DoublesVelocitiesAndFrequencies) {
  const auto check = [](const Measures& slow, const Measures& fast) {
    for (const Measure measure : {Measure::Mvelo, Measure::MveloAp, Measure::MveloMl, Measure::AreaSw, Measure::Mfreq, Measure::MfreqAp,
                                  Measure::MfreqMl, Measure::VmaxAp, Measure::VmaxMl}) {
      expect_near(measure, fast, 2.0 * *slow.get(measure), 1e-12);
    }
    for (const Measure measure : {Measure::Mdist, Measure::Totex, Measure::Pea95F, Measure::Range, Measure::FdCc, Measure::Lfs}) {
      expect_near(measure, fast, *slow.get(measure), 1e-12);
    }
  };
  change_people([](CopSeries& series) { series.rate_hz *= 2.0; }, check, {.preparation = {.profile = Profile::AsIs}});
}

}  // namespace
}  // namespace dts::posturography
