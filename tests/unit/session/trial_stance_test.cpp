// SPDX-License-Identifier: Apache-2.0
#include "session/trial_stance.h"

#include <gtest/gtest.h>

namespace dts::session {
namespace {

class TrialStance : public testing::Test {
 protected:
  void announce(TrialEventKind kind, std::vector<std::pair<std::string, std::string>> labels, std::uint64_t scan) {
    announce_feet(stances_, {.kind = kind, .trial = 1, .labels = std::move(labels)}, 3, {scan}, core::Rate::from_hz(100.0).value());
  }
  pipeline::SubjectStances stances_;
};

TEST_F(TrialStance, GoOfATrialOnOneFoot_IsValidHalfASecondLater) {
  stances_.begin(180.0);
  announce(TrialEventKind::Go, {{"eyes", "open"}, {"feet", "one"}}, 1000);

  const pipeline::SubjectStance& stance = stances_.latest();
  EXPECT_FALSE(stance.is_on_two_feet);
  EXPECT_EQ(stance.segment, 3U);
  EXPECT_EQ(stance.first_scan.value, 1050U);
  EXPECT_EQ(stance.width_mm, 180.0) << "still known for the next trial";
}

TEST_F(TrialStance, OtherTrials_AreOnTwoFeetAgain) {
  announce(TrialEventKind::Go, {{"feet", "one"}}, 1000);
  announce(TrialEventKind::Go, {{"eyes", "closed"}}, 2000);

  EXPECT_TRUE(stances_.latest().is_on_two_feet);
  EXPECT_EQ(stances_.latest().first_scan.value, 2050U);
}

TEST_F(TrialStance, OnlyGo_Counts) {
  for (const TrialEventKind kind : {TrialEventKind::Ready, TrialEventKind::Measure, TrialEventKind::Done, TrialEventKind::Finished}) {
    announce(kind, {{"feet", "one"}}, 1000);
  }
  EXPECT_EQ(stances_.latest().number, 0U);
}

TEST_F(TrialStance, SessionThatBegins_ForgetsTheLastOne) {
  announce(TrialEventKind::Go, {{"feet", "one"}}, 1000);
  stances_.begin(0.0);

  EXPECT_TRUE(stances_.latest().is_on_two_feet);
  EXPECT_EQ(stances_.latest().width_mm, 0.0);
}

TEST_F(TrialStance, WidthOfTheFields) {
  EXPECT_EQ(stance_width_mm({{"weight_kg", "70"}, {"stance_width_mm", "182.5"}}), 182.5);
  EXPECT_EQ(stance_width_mm({{"weight_kg", "70"}}), 0.0);
}

}  // namespace
}  // namespace dts::session
