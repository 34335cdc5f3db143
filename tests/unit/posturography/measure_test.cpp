// SPDX-License-Identifier: Apache-2.0
#include "posturography/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace dts::posturography {
namespace {

TEST(Measure, EachHasASymbolOfItsOwnAKnownUnitAndASentence) {
  RecordProperty("requirement", "SWAY-1");
  const std::set<std::string_view> units = {"mm", "mm/s", "mm2", "mm2/s", "Hz", "s", "deg", "deg/s", "1", "1/mm", "%"};
  std::set<std::string_view> symbols;
  for (std::size_t index = 0; index < kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    EXPECT_TRUE(symbols.insert(info(measure).symbol).second) << info(measure).symbol;
    EXPECT_EQ(measure_named(info(measure).symbol), measure);
    EXPECT_TRUE(units.contains(info(measure).unit)) << info(measure).symbol;
    EXPECT_GT(info(measure).sentence.size(), 10U) << info(measure).symbol;
  }
  EXPECT_FALSE(measure_named("MVELO_"));
  EXPECT_FALSE(measure_named(""));
}

TEST(Measure, SymbolsOfTheContract) {
  for (const std::string_view symbol :
       {"MDIST",       "RDIST_AP",          "TOTEX_ML",       "MVELO",        "RANGE",     "MAXDIST",    "SD1_AP",
        "AREA_CC",     "AREA_CE",           "PEA95_F",        "PEA95_CHI2",   "ELL_SD1",   "ELL_ANGLE",  "AREA_HULL",
        "AREA_SW",     "MFREQ_AP",          "FD_CC",          "FD_CE",        "VMAX_AP",   "AAMV2S_ML",  "POWER_RD_MT8",
        "PF50_AP_MT8", "PF95_ML_MT8",       "CFREQ_RD_MT8",   "FREQD_AP_MT8", "MSD_AP_1s", "MSD_RES_1s", "SDA_DS_AP",
        "SDA_TC_RES",  "SAMPEN_AP_20HZ",    "SAMPEN_ML_20HZ", "HC_MEANABS",   "HC_SD",     "HC_RATE",    "LFS",
        "AP_USE",      "MPF_RES_WELCHHALF", "MSD_AP_100ms",   "MPF_AP_MT8"}) {
    EXPECT_TRUE(measure_named(symbol)) << symbol;
  }
}

TEST(Measure, FamiliesAreInOrderOfTheAxes) {
  EXPECT_EQ(info(of(Measure::Mdist, Axis::Ml)).symbol, "MDIST_ML");
  EXPECT_EQ(info(of(Measure::Msd10sRes, Axis::Ap)).symbol, "MSD_AP_10s");
  EXPECT_EQ(info(of(Measure::SdaTcRes, Axis::Ml)).symbol, "SDA_TC_ML");
  EXPECT_EQ(info(of(Measure::Pf95Rd, Axis::Ap)).symbol, "PF95_AP_MT8");
}

TEST(Measure, WhatHasNoQuotientSaysSo) {
  for (const Measure measure :
       {Measure::EllAngle, Measure::SampenAp, Measure::FdCe, Measure::SdaHsAp, Measure::SdaDlAp, Measure::HcMeanabs}) {
    EXPECT_FALSE(info(measure).is_ratio_scaled) << info(measure).symbol;
  }
  for (const Measure measure : {Measure::Mvelo, Measure::Pea95F, Measure::Mfreq, Measure::Pf50Ap, Measure::ApUse}) {
    EXPECT_TRUE(info(measure).is_ratio_scaled) << info(measure).symbol;
  }
}

TEST(Measures, ValuesAreFiniteOrAbsent) {
  Measures measures;
  EXPECT_EQ(measures.count(), 0U);

  measures.set(Measure::Mvelo, 8.0);
  measures.set(Measure::Mdist, 0.0);
  measures.set(Measure::Mfreq, std::numeric_limits<double>::quiet_NaN());
  measures.set(Measure::FdCc, std::numeric_limits<double>::infinity());
  measures.set(static_cast<Measure>(255), 1.0);

  EXPECT_EQ(measures.count(), 2U);
  EXPECT_EQ(measures.get(Measure::Mvelo), 8.0);
  EXPECT_EQ(measures.get(Measure::Mdist), 0.0);
  EXPECT_FALSE(measures.has(Measure::Mfreq));
  EXPECT_FALSE(measures.has(Measure::FdCc));

  measures.set(Measure::EllAngle, -0.0);
  EXPECT_FALSE(std::signbit(*measures.get(Measure::EllAngle)));
}

}  // namespace
}  // namespace dts::posturography
