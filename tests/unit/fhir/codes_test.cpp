// SPDX-License-Identifier: Apache-2.0
#include "fhir/codes.h"

#include <gtest/gtest.h>

#include <set>

#include "fhir/resource_id.h"
#include "support/committed_text.h"

namespace dts::fhir {
namespace {

TEST(CodesTest, EveryCode_IsUniqueAndHasWordsAndAUnitOfUcum) {
  std::set<std::string> seen;
  for (const Code& one : all_codes()) {
    EXPECT_TRUE(seen.insert(one.code).second) << one.code;
    EXPECT_NE(one.display, "") << one.code;
    EXPECT_NE(one.display, one.code) << "no plain words for " << one.code;
    EXPECT_TRUE(one.unit.empty() || ucum_of(one.unit)) << one.code << " in " << one.unit;
    EXPECT_EQ(find_code(one.code), &one);
  }
  EXPECT_GT(seen.size(), 100U);
}

TEST(CodesTest, AnUnknownCode_IsOnlyText) { EXPECT_EQ(concept_of("of_a_later_version").dump(), R"({"text":"of_a_later_version"})"); }

TEST(CodesTest, AnUnknownUnit_HasNoCode) {
  EXPECT_EQ(quantity(2.5, "furlong").dump(), R"({"value":2.5,"unit":"furlong"})");
  EXPECT_EQ(quantity(2.5, "").dump(), R"({"value":2.5})");
}

TEST(CodesTest, ReciprocalMillimetres_AreWrittenAsUcumDoes) { EXPECT_EQ(quantity(0.5, "1/mm")["code"], "/mm"); }

TEST(CodesTest, Values_HaveSixDigits) {
  EXPECT_EQ(quantity(1234567.0, "mm")["value"], 1234570.0);
  EXPECT_EQ(quantity(-0.00012345678, "mm")["value"], -0.000123457);
  EXPECT_EQ(quantity(0.0, "mm")["value"], 0.0);
}

/// The values are those of Python's uuid.uuid5.
TEST(ResourceIdTest, IsAUuidOfVersion5) {
  record::SessionFacts facts{.session_id = "S", .part = 1, .started_utc_ns = 2, .boot_id = "b"};

  EXPECT_EQ(resource_id(facts, "patient"), "b3d522a5-a067-51a8-a228-c4298e750e41");
}

/// A hospital loads this file into its terminology server.
TEST(CodesTest, TheCodeSystemOfTheDocumentation_IsThisOne) { test::expect_committed("../docs/fhir-codes.json", code_system_text()); }

}  // namespace
}  // namespace dts::fhir
