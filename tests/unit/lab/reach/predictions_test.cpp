// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/predictions.h"

#include <gmock/gmock.h>

namespace dts::lab::reach {
namespace {

using testing::EndsWith;

constexpr const char* kHead = "subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg\n";

std::string line_of(const Prediction& prediction) {
  const std::string text = prediction_text({&prediction, 1});
  return text.substr(std::string(kHead).size());
}

Prediction reaching() {
  core::ReachEvent reach{.step = core::ReachStep::Final,
                         .p1 = {.scan = core::ScanIndex{150}, .value_mm = 3.7},
                         .p2 = {.scan = core::ScanIndex{300}, .value_mm = 3.3},
                         .p3 = {.scan = core::ScanIndex{1500}, .value_mm = 5.2}};
  reach.features.p1_mm = 3.7;
  reach.features.p2_mm = 3.3;
  reach.features.p3_mm = 5.2;
  return {.subject = "A", .trial = 7, .rate = core::Rate::from_hz(1500.0).value(), .reach = reach, .movement = std::nullopt};
}

TEST(Predictions, NothingFound_IsEmptyCells) {
  EXPECT_EQ(prediction_text({}), kHead);
  EXPECT_EQ(line_of({.subject = "A", .trial = 7, .rate = {}, .reach = std::nullopt, .movement = std::nullopt}), "A,7,,,,,,,,,,,\n");
}

TEST(Predictions, Times_AreSecondsFromTheFirstSample) {
  EXPECT_EQ(line_of(reaching()), "A,7,0.1000,0.2000,1.0000,3.7000,3.3000,5.2000,,,,,\n");
}

TEST(Predictions, UnknownPoint_IsEmpty) {
  Prediction prediction = reaching();
  prediction.reach->p3 = {};
  prediction.reach->features.p3_mm = core::ReachFeatures::kUnknown;

  EXPECT_EQ(line_of(prediction), "A,7,0.1000,0.2000,,3.7000,3.3000,,,,,,\n");
}

TEST(Predictions, Class_HasItsOwnProbability) {
  Prediction prediction = reaching();
  prediction.movement = core::TrunkMovement{.trunk_class = core::TrunkClass::Moderate,
                                            .probability = {0.02, 0.95, 0.03},
                                            .trunk_deg = 27.3,
                                            .trunk_lo_deg = 20.1,
                                            .trunk_hi_deg = 33.0};

  EXPECT_THAT(line_of(prediction), EndsWith(",2,0.9500,27.30,20.10,33.00\n"));
}

TEST(Predictions, RejectedAndNone_HaveNoProbability) {
  Prediction prediction = reaching();
  prediction.movement = core::TrunkMovement{.trunk_class = core::TrunkClass::Rejected, .probability = {0.5, 0.5, 0.0}};
  EXPECT_THAT(line_of(prediction), EndsWith(",-1,,,,\n"));
  prediction.movement->trunk_class = core::TrunkClass::None;
  EXPECT_THAT(line_of(prediction), EndsWith(",0,,,,\n"));
}

TEST(Predictions, NameWithAComma_StaysOneCell) {
  Prediction prediction = reaching();
  prediction.subject = "A, the \"first\"";

  EXPECT_THAT(line_of(prediction), testing::StartsWith("\"A, the \"\"first\"\"\",7,"));
}

TEST(Predictions, NameThatASpreadsheetWouldCompute_IsText) {
  Prediction prediction = reaching();
  prediction.subject = "=cmd";

  EXPECT_THAT(line_of(prediction), testing::StartsWith("'=cmd,7,"));
}

}  // namespace
}  // namespace dts::lab::reach
