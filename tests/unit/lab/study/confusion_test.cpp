// SPDX-License-Identifier: Apache-2.0
#include "lab/study/confusion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lab/study/study_view.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;

Confusion made() {
  Confusion answers;
  for (int k = 0; k < 12; ++k) answers.add(TrunkClass::Moderate, TrunkClass::Moderate);
  for (int k = 0; k < 2; ++k) answers.add(TrunkClass::Moderate, TrunkClass::Maximum);
  answers.add(TrunkClass::Moderate, TrunkClass::Rejected);
  answers.add(TrunkClass::None, TrunkClass::Minor);
  return answers;
}

TEST(Confusion, Counts_AreOfWhatWasWantedAndAnswered) {
  const Confusion answers = made();
  EXPECT_EQ(answers.total(), 16U);
  EXPECT_EQ(answers.correct(), 12U);
  EXPECT_EQ(answers.of(TrunkClass::Moderate), 15U);
  EXPECT_EQ(answers.count(TrunkClass::Moderate, TrunkClass::Maximum), 2U);
  EXPECT_EQ(answers.kept(), 15U);
}

TEST(Confusion, Shares_LeaveTheArmAloneOutOnRequest) {
  const Confusion answers = made();
  EXPECT_DOUBLE_EQ(answers.accuracy(), 12.0 / 16.0);
  EXPECT_DOUBLE_EQ(answers.of_trunk().accuracy(), 12.0 / 15.0);
  EXPECT_DOUBLE_EQ(answers.of_trunk().kept_accuracy(), 12.0 / 14.0);
  EXPECT_DOUBLE_EQ(answers.of_trunk().kept_share(), 14.0 / 15.0);
}

TEST(Confusion, Nothing_HasNoShares) {
  const Confusion none;
  EXPECT_TRUE(std::isnan(none.accuracy()));
  EXPECT_TRUE(std::isnan(none.kept_accuracy()));
}

TEST(Confusion, ClassesOutOfRange_StayWithinTheTable) {
  Confusion answers;
  answers.add(static_cast<TrunkClass>(100), static_cast<TrunkClass>(-100));
  EXPECT_EQ(answers.count(TrunkClass::Maximum, TrunkClass::Rejected), 1U);
}

TEST(Confusion, Cell_SaysWhatTheOthersWere) {
  EXPECT_EQ(cell_text(made(), TrunkClass::Moderate), "12 (1 no answer, 2 maximum)");
  EXPECT_EQ(cell_text(made(), TrunkClass::None), "0 (1 minor)");
  EXPECT_EQ(cell_text(made(), TrunkClass::Minor), "-");
}

}  // namespace
}  // namespace dts::lab::study
