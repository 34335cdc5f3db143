// SPDX-License-Identifier: Apache-2.0
#include "lab/reach/predictions.h"

#include <gtest/gtest.h>

namespace dts::lab::reach {
namespace {

constexpr const char* kHead = "subject,trial,t_p1,t_p2,t_p3,p1_mm,p2_mm,p3_mm,class,p_class,trunk_deg,trunk_lo_deg,trunk_hi_deg\n";

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

TEST(Predictions, EachTrial_IsALineWithWhatIsKnown) {
  const std::string points = "0.1000,0.2000,1.0000,3.7000,3.3000,5.2000,";
  std::vector<std::pair<Prediction, std::string>> cases{
      {reaching(), "A,7," + points + ",,,,"}, {{.subject = "A", .trial = 7, .rate = {}, .reach = {}, .movement = {}}, "A,7,,,,,,,,,,,"}};
  const auto add = [&](auto&& change, const std::string& line) { change(cases.emplace_back(reaching(), line).first); };
  const auto classed = [](core::TrunkClass trunk_class) {
    return [=](Prediction& prediction) {
      prediction.movement = core::TrunkMovement{
          .trunk_class = trunk_class, .probability = {0.02, 0.95, 0.03}, .trunk_deg = 27.3, .trunk_lo_deg = 20.1, .trunk_hi_deg = 33.0};
    };
  };
  add(classed(core::TrunkClass::Minor), "A,7," + points + "1,0.0200,27.30,20.10,33.00");
  add(classed(core::TrunkClass::Moderate), "A,7," + points + "2,0.9500,27.30,20.10,33.00");
  add(classed(core::TrunkClass::Maximum), "A,7," + points + "3,0.0300,27.30,20.10,33.00");
  add(classed(core::TrunkClass::Rejected), "A,7," + points + "-1,,27.30,20.10,33.00");
  add([](Prediction& prediction) { prediction.movement = core::TrunkMovement{.trunk_class = core::TrunkClass::None}; },
      "A,7," + points + "0,,,,");
  add(
      [](Prediction& prediction) {
        prediction.reach->p3 = {};
        prediction.reach->features.p3_mm = core::ReachFeatures::kUnknown;
      },
      "A,7,0.1000,0.2000,,3.7000,3.3000,,,,,,");
  add([](Prediction& prediction) { prediction.subject = "A, the \"first\""; }, "\"A, the \"\"first\"\"\",7," + points + ",,,,");
  add([](Prediction& prediction) { prediction.subject = "=cmd"; }, "'=cmd,7," + points + ",,,,");

  for (const auto& [prediction, line] : cases) EXPECT_EQ(prediction_text({&prediction, 1}), kHead + line + "\n");
  EXPECT_EQ(prediction_text({}), kHead);
}

}  // namespace
}  // namespace dts::lab::reach
