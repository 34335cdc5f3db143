// SPDX-License-Identifier: Apache-2.0
// Posturography sheet section 10: every value for the example recordings, computed there by other programs. They are of real people and
// lie beside the checkout, not in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "posturography/analysis.h"
#include "unit/posturography/recorded_cop.h"

namespace dts::posturography {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();  // the sheet has none

struct Row {
  std::string_view symbol;
  std::array<double, 4> values;  ///< d01 asis, d01 lp10, d02 lp10, d03 lp10.
};

// clang-format off: a measure a line
constexpr std::array kRows = {
    Row{"MDIST", {5.607741201, 5.607711629, 5.055400539, 3.388754263}},
    Row{"MDIST_AP", {4.895430423, 4.895416625, 4.078594548, 2.647702322}},
    Row{"MDIST_ML", {2.126874535, 2.126873278, 2.34177084, 1.607385704}},
    Row{"RDIST", {6.669119228, 6.669148802, 5.710357002, 3.771771589}},
    Row{"RDIST_AP", {6.094200841, 6.094251642, 5.023629424, 3.160393933}},
    Row{"RDIST_ML", {2.708849827, 2.708808349, 2.715018323, 2.058681885}},
    Row{"TOTEX", {491.2699105, 484.1745146, 559.946233, 257.3061208}},
    Row{"TOTEX_AP", {323.98664, 317.8469684, 401.6920519, 230.7824565}},
    Row{"TOTEX_ML", {294.44455, 291.3131287, 302.1320151, 74.24432945}},
    Row{"MVELO", {8.187831842, 8.069575243, 9.332437217, 8.040816275}},
    Row{"MVELO_AP", {5.399777333, 5.297449473, 6.694867532, 7.211951767}},
    Row{"MVELO_ML", {4.907409167, 4.855218812, 5.035533585, 2.320135295}},
    Row{"RANGE", {29.58605104, 29.57077977, 29.56946919, 14.74452374}},
    Row{"RANGE_AP", {29.17933, 29.1403387, 29.52452265, 14.63746969}},
    Row{"RANGE_ML", {15.50653, 15.49991948, 16.08234414, 12.97600507}},
    Row{"MAXDIST", {19.33157228, 19.31809308, 16.54358299, 8.23154044}},
    Row{"AREA_CC", {418.7916852, 418.8015425, 278.9819471, 117.3977611}},
    Row{"AREA_CE", {304.7259435, 304.7222233, 254.6837334, 115.9728118}},
    Row{"PEA95_F", {304.5967519, 304.5930332, 254.5757577, 115.8295333}},
    Row{"PEA95_CHI2", {304.3431717, 304.3394561, 254.3638206, 115.8114509}},
    Row{"ELL_SD1", {6.125028222, 6.125084833, 5.043146432, 3.268511251}},
    Row{"ELL_SD2", {2.639809586, 2.63975296, 2.67960571, 1.882429203}},
    Row{"ELL_ANGLE", {83.67720332, 83.67667071, -84.10922768, -71.82339248}},
    Row{"AREA_HULL", {303.1896979, 302.4377921, 336.9823005, 117.9204133}},
    Row{"AREA_SW", {13.62759424, 13.44713327, 15.29874301, 6.410402696}},
    Row{"MFREQ", {0.2323812501, 0.2290261828, 0.2938053083, 0.3776419172}},
    Row{"MFREQ_AP", {0.1949889407, 0.1912943643, 0.2901726425, 0.481513722}},
    Row{"MFREQ_ML", {0.4078828161, 0.4035452161, 0.3801247205, 0.255163306}},
    Row{"FD_CC", {1.541923078, 1.537954143, 1.638934812, 1.415830126}},
    Row{"FD_CE", {1.586631287, 1.582434314, 1.653124658, 1.417011039}},
    Row{"VMAX_AP", {94.171, 83.9094184, 60.77634403, 53.00403131}},
    Row{"AAMV2S_AP", {17.53706897, 16.83227857, 24.351652, 28.51818523}},
    Row{"AAMV2S_ML", {16.795, 16.2593779, 16.91083288, 8.126210347}},
    Row{"POWER_RD_MT8", {2.481967096, 2.482097692, 2.581814746, 1.922181859}},
    Row{"POWER_AP_MT8", {4.166074271, 4.166062401, 4.279875397, 4.871440013}},
    Row{"POWER_ML_MT8", {2.089108663, 2.089102363, 2.855900085, 1.070356868}},
    Row{"PF50_AP_MT8", {0.2166666667, 0.2166666667, 0.3666666667, 0.46875}},
    Row{"PF95_AP_MT8", {1.066666667, 1.066666667, 1.166666667, 1.4375}},
    Row{"CFREQ_AP_MT8", {0.4647097158, 0.464653014, 0.637669252, 0.730652435}},
    Row{"FREQD_AP_MT8", {0.7043986029, 0.7043348231, 0.6280505497, 0.6255560225}},
    Row{"CFREQ_RD_MT8", {0.659291225, 0.659258139, 0.7708961966, 0.9584115344}},
    Row{"MPF_RES_WELCHHALF", {0.1478907609, 0.1475373753, 0.2553625093, 0.3766663147}},
    Row{"MSD_AP_1s", {8.162873569, 8.161584802, 10.03546715, 10.45035578}},
    Row{"SDA_DS_AP", {4.259065454, 4.258672887, 8.376767063, 9.540396339}},
    Row{"SDA_DL_AP", {2.752626004, 2.752686888, 1.039823057, 0.5040351402}},
    Row{"SDA_HS_AP", {0.8223409676, 0.8271963753, 0.847062763, 0.8291371168}},
    Row{"SDA_HL_AP", {0.3845426417, 0.3845623832, 0.2308770407, 0.1683671631}},
    Row{"SDA_TC_AP", {1.801273585, 1.801775494, 0.8676577513, 0.6891109825}},
    Row{"SAMPEN_AP_20HZ", {kNone, 0.1603708957, 0.267312376, 0.4105504319}},
    Row{"SAMPEN_ML_20HZ", {kNone, 0.3570646942, 0.3195592259, 0.207250107}},
    Row{"HC_MEANABS", {kNone, 36.38773015, 32.97173507, 28.21928143}},
    Row{"HC_SD", {kNone, 53.14333501, 48.91867211, 47.65287553}},
};
// clang-format on

/// The sheet prints ten digits.
constexpr double kPrinted = 5e-10;

struct CheckedRecord {
  std::string_view file;
  Profile profile;
  double rate_hz;
  std::size_t samples;
};
constexpr std::array kRecords = {CheckedRecord{"d01_bds00073_young_eo_firm.csv", Profile::AsIs, 100.0, 6000},
                                 CheckedRecord{"d01_bds00073_young_eo_firm.csv", Profile::Lp10, 100.0, 6000},
                                 CheckedRecord{"d02_bds00079_young_ec_firm.csv", Profile::Lp10, 100.0, 6000},
                                 CheckedRecord{"d03_acuna_eo2_1000hz.csv", Profile::Lp10, 1000.0, 32000}};

/// Frequencies are bins, entropies and diffusion are said to agree to 1e-9 and 1e-6; all that a filter touches to 2e-4, for paddings
/// differ. Ours is the padding of the sheet: everything agrees to what it prints.
constexpr double kTolerance = 1e-9 + kPrinted;

TEST(CheckValues, AgreeToTheirLastDigit) {
  RecordProperty("requirement", "SWAY-1");
  for (std::size_t column = 0; column < kRecords.size(); ++column) {
    const CheckedRecord& record = kRecords[column];
    SCOPED_TRACE(record.file);
    const auto cop = test::recorded_cop(record.file);
    if (!cop) GTEST_SKIP() << "no recordings beside this checkout";
    ASSERT_EQ(cop->rate_hz, record.rate_hz);

    const auto analysis = analyse(*cop, {.preparation = {.profile = record.profile}});

    ASSERT_TRUE(analysis) << analysis.error().what;
    EXPECT_EQ(analysis->samples, record.samples);
    // Section 5 reports a critical time only where D_S is above 2 D_L, section 10 prints one for d01 also: it is reported, and flagged.
    EXPECT_EQ(analysis->flags, column < 2 ? sway_flag::kUnclearCriticalPoint : 0U);
    for (const Row& row : kRows) {
      const auto measure = measure_named(row.symbol);
      ASSERT_TRUE(measure) << row.symbol;
      const double expected = row.values[column];
      const auto value = analysis->measures.get(*measure);
      EXPECT_EQ(value.has_value(), !std::isnan(expected)) << row.symbol;
      if (value && !std::isnan(expected)) {
        EXPECT_NEAR(*value, expected, kTolerance * std::abs(expected)) << row.symbol;
      }
    }
  }
}

}  // namespace
}  // namespace dts::posturography
