// SPDX-License-Identifier: Apache-2.0
#include "report/result_names.h"

#include <gtest/gtest.h>

namespace dts::report {
namespace {

TEST(ResultNames, PlainNameFirst_SymbolBehindIt) {
  for (const auto& [name, expected] :
       {std::pair{"eyes-open/MVELO", "eyes-open: Mean velocity (MVELO)"},
        {"a/b/RANGE_AP", "a/b: Range, AP (RANGE_AP)"},
        {"closed/PEA95_F", "closed: 95 % ellipse (PEA95_F)"},
        {"romberg/feet=two,surface=foam/MVELO", "Romberg quotient, feet two, surface foam: Mean velocity (MVELO)"},
        {"romberg/MVELO", "Romberg quotient: Mean velocity (MVELO)"},
        {"rombergs/MVELO", "rombergs: Mean velocity (MVELO)"},
        {"trunk_sd_deg", "Trunk angle, SD within a target (trunk_sd_deg)"},
        {"closed/MVELO_part_2", "closed: Mean velocity (MVELO), part 2"},
        {"load_n_part_12", "Load while standing (load_n), part 12"},
        {"closed/SOMETHING", "closed: SOMETHING"},
        {"MSD_AP_1s", "Mean square displacement after 1 s, AP (MSD_AP_1s)"},
        {"", ""}}) {
    EXPECT_EQ(result_label(name), expected) << name;
  }
}

TEST(ResultNames, Parts_OfNamesThatOnlyLookLikeAPart) {
  for (const char* name : {"a_part_1", "a_part_0", "a_part_02", "a_part_", "a_part_12345678901234567890", "12", "part_2"}) {
    EXPECT_EQ(parts_of(name).part, 1U) << name;
    EXPECT_EQ(parts_of(name).symbol, name);
  }
  const ResultName parts = parts_of("eyes-open/part_2/MVELO_part_3");
  EXPECT_EQ(parts.group + " " + parts.symbol + " " + std::to_string(parts.part), "eyes-open/part_2 MVELO 3");
}

TEST(ResultNames, EachFaultHasItsWords) {
  std::string all;
  for (int fault = 0; fault <= v1::TrialFault_MAX; ++fault) all += fault_words(static_cast<v1::TrialFault>(fault)) + ";";
  EXPECT_EQ(all, ";stepped off;feet moved;no reach;no values;");
}

}  // namespace
}  // namespace dts::report
