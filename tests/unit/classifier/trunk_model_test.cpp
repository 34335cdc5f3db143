// SPDX-License-Identifier: Apache-2.0
#include "classifier/trunk_model.h"

#include <gtest/gtest.h>

#include <limits>
#include <tuple>
#include <vector>

#include "physics/body/person.h"
#include "unit/classifier/hand_made_model.h"

namespace dts::classifier {
namespace {

namespace flag = core::reach_flag;
namespace reason = core::class_reason;
using core::TrunkClass;

TrunkModel model() { return TrunkModel::create(hand_made_form()).value(); }

static_assert(kModerateFromDeg == physics::kModerateFromDeg && kMaximumFromDeg == physics::kMaximumFromDeg);

TEST(TrunkModel, ReachInTheMiddleOfEachClass_IsOfThatClass) {
  EXPECT_EQ(model().classify(reach_of(0.1), 0).trunk_class, TrunkClass::Minor);
  EXPECT_EQ(model().classify(reach_of(0.3), 0).trunk_class, TrunkClass::Moderate);
  EXPECT_EQ(model().classify(reach_of(0.55), 0).trunk_class, TrunkClass::Maximum);
}

TEST(TrunkModel, AnyReach_ProbabilitiesSumToOneAndAngleLiesInItsInterval) {
  for (const double d2 : {-0.1, 0.0, 0.05, 0.2, 0.4, 0.6, 2.0}) {
    const auto movement = model().classify(reach_of(d2), 0);

    EXPECT_NEAR(movement.probability[0] + movement.probability[1] + movement.probability[2], 1.0, 1e-12);
    EXPECT_LE(movement.trunk_lo_deg, movement.trunk_deg);
    EXPECT_GE(movement.trunk_hi_deg, movement.trunk_deg);
    EXPECT_GE(movement.trunk_lo_deg, 0.0);
    EXPECT_LE(movement.trunk_hi_deg, 90.0);
  }
}

TEST(TrunkModel, ReachAtABorder_RejectedAsUnsureButGuessed) {
  const auto movement = model().classify(reach_of(0.2), 0);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected);
  EXPECT_NE(movement.reasons & reason::kUnsure, 0);
  EXPECT_NE(model().best_guess(reach_of(0.2), 0).trunk_class, TrunkClass::Rejected);
}

TEST(TrunkModel, ArmAlone_IsClassZeroOnlyWhenTheRuleIsSure) {
  EXPECT_EQ(model().classify(reach_of(0.01), flag::kMinor).trunk_class, TrunkClass::None);
  EXPECT_EQ(model().classify(reach_of(0.039), flag::kMinor).trunk_class, TrunkClass::Minor);
}

TEST(TrunkModel, MinorReach_NeverAboveClassOne) {
  for (const double d2 : {0.0, 0.1, 0.3, 0.55, 0.9}) {
    EXPECT_LE(model().classify(reach_of(d2), flag::kMinor).trunk_class, TrunkClass::Minor);
    EXPECT_LE(model().best_guess(reach_of(d2), flag::kMinor).trunk_class, TrunkClass::Minor);
  }
}

class UnfitFlag : public testing::TestWithParam<std::uint16_t> {};

TEST_P(UnfitFlag, ClearReachWithIt_RejectedAsBadReach) {
  const auto movement = model().classify(reach_of(0.3), GetParam());

  EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected);
  EXPECT_NE(movement.reasons & reason::kBadReach, 0);
}

INSTANTIATE_TEST_SUITE_P(All, UnfitFlag,
                         testing::Values(flag::kDipOnly, flag::kTimeout, flag::kSaturated, flag::kImplausible, flag::kStoodUp,
                                         flag::kUntared));

TEST(TrunkModel, FlagsThatOnlyWarn_DoNotReject) {
  for (const std::uint16_t flags : {flag::kBaselineUncertain, flag::kResumed, flag::kNoInitiation}) {
    EXPECT_EQ(model().classify(reach_of(0.3), flags).trunk_class, TrunkClass::Moderate);
  }
}

TEST(TrunkModel, DoubtfulLevels_OnlyWhatIsFarFromABorderStands) {
  const double near_border = 0.203;  // sure enough with all sensors, not with three

  EXPECT_EQ(model().classify(reach_of(near_border), 0).trunk_class, TrunkClass::Moderate);
  for (const std::uint16_t flags : {flag::kSubstituted, flag::kResumed, flag::kBaselineUncertain}) {
    EXPECT_EQ(model().classify(reach_of(near_border), flags).trunk_class, TrunkClass::Rejected) << flags;
    EXPECT_EQ(model().classify(reach_of(0.3), flags).trunk_class, TrunkClass::Moderate) << flags;
  }
}

TEST(TrunkModel, BodyFarFromThoseOfTheTraining_RejectedAsOutOfRange) {
  for (const double p1_mm : {1.2, 2.0, 6.2, 9.0}) {  // a child's, a light one's, 130 kg
    const auto movement = model().classify(reach_of(0.3, p1_mm), 0);

    EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected) << p1_mm;
    EXPECT_NE(movement.reasons & reason::kOutOfRange, 0) << p1_mm;
  }
}

TEST(TrunkModel, SwingFarBeyondTheTraining_RejectedAndTheAngleIsThatOfTheRangesEnd) {
  const auto movement = model().classify(reach_of(1.5), 0);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected);
  EXPECT_NE(movement.reasons & reason::kOutOfRange, 0);
  EXPECT_NEAR(movement.trunk_deg, std::asin(0.9) * 180.0 / 3.14159265358979, 1e-9);
}

TEST(TrunkModel, NumberThatIsNotFinite_Rejected) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}) {
    for (double core::ReachFeatures::*member : {&core::ReachFeatures::p1_mm, &core::ReachFeatures::p2_mm, &core::ReachFeatures::p3_mm}) {
      auto features = reach_of(0.3);
      features.*member = bad;

      EXPECT_EQ(model().classify(features, 0).trunk_class, TrunkClass::Rejected);
      EXPECT_EQ(model().best_guess(features, 0).trunk_class, TrunkClass::Rejected);
    }
  }
  EXPECT_EQ(model().classify({}, 0).trunk_class, TrunkClass::Rejected);
}

TEST(TrunkModel, ClassOutsideOfTheAnglesInterval_RejectedAsDisagreement) {
  auto form = hand_made_form();
  form.angle->sine.coefficients = {0.05, 0.0, 0.0};  // 3 degrees, whatever it sees

  const auto movement = TrunkModel::create(form).value().classify(reach_of(0.55), 0);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected);
  EXPECT_NE(movement.reasons & reason::kDisagreement, 0);
}

TEST(TrunkModel, OwnScale_DecidesForSomebodyWhoBendsThePlateLess) {
  const std::vector<core::ReachFeatures> maximum(3, reach_of(0.42));
  const auto subject = calibrate_subject(maximum, 48.0).value();

  const auto movement = model().classify(reach_of(0.41), 0, &subject);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Maximum);
  EXPECT_NE(movement.reasons & reason::kCalibrated, 0);
  EXPECT_EQ(model().classify(reach_of(0.19), 0, &subject).trunk_class, TrunkClass::Moderate);
}

TEST(TrunkModel, OwnMaximumBelowClassThree_AngleTellsAndItIsNotClassThree) {
  const std::vector<core::ReachFeatures> maximum(3, reach_of(0.3));  // seen as 26.7 degrees
  const auto subject = calibrate_subject(maximum, 25.0).value();

  const auto movement = model().best_guess(reach_of(0.3), 0, &subject);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Moderate);
  EXPECT_NEAR(movement.trunk_deg, 26.7, 0.1);
}

TEST(TrunkModel, OwnMaximumFarFromGeometry_TheSeenAngleCounts) {
  const std::vector<core::ReachFeatures> maximum(3, reach_of(0.5));  // seen as 48.6 degrees
  const auto subject = calibrate_subject(maximum, 80.0).value();

  EXPECT_NEAR(model().classify(reach_of(0.5), 0, &subject).trunk_deg, 48.6, 0.1);
}

TEST(TrunkModel, ScaleWithoutNumbers_IsIgnored) {
  const SubjectCalibration nothing;

  const auto movement = model().classify(reach_of(0.3), 0, &nothing);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Moderate);
  EXPECT_EQ(movement.reasons & reason::kCalibrated, 0);
}

TEST(TrunkModel, Untrained_RejectsEverything) {
  EXPECT_EQ(TrunkModel{}.classify(reach_of(0.3), 0).trunk_class, TrunkClass::Rejected);
  EXPECT_EQ(TrunkModel{}.best_guess(reach_of(0.3), 0).trunk_class, TrunkClass::Rejected);
}

TEST(TrunkModelForm, TrainingThatFailed_Refused) {
  auto form = hand_made_form();
  form.figures.validation_accuracy = 0.89;
  EXPECT_FALSE(TrunkModel::create(form));
  form.figures.validation_accuracy = ModelFigures::kUnknown;
  EXPECT_FALSE(TrunkModel::create(form));
}

TEST(TrunkModelForm, PartsThatDoNotFit_Refused) {
  const std::vector<void (*)(TrunkModelForm&)> damages = {
      [](TrunkModelForm& form) { form.general.networks.clear(); },
      [](TrunkModelForm& form) {
        form.general.inputs.push_back({ReachFeature::D1, 0.0, 1.0});
      },
      [](TrunkModelForm& form) { form.general.inputs[0].maximum = form.general.inputs[0].minimum; },
      [](TrunkModelForm& form) { form.general.inputs[0].feature = ReachFeature::OwnD2; },
      [](TrunkModelForm& form) { form.general.temperature = 0.0; },
      [](TrunkModelForm& form) { form.angle->sine.coefficients.push_back(0.0); },
      [](TrunkModelForm& form) { form.angle->sine.coefficients[1] = std::numeric_limits<double>::infinity(); },
      [](TrunkModelForm& form) { form.own_angle->residual_deg[2] = 0.0; },
      [](TrunkModelForm& form) { form.arm_alone->none_from = 0.4; },
      [](TrunkModelForm& form) { form.reject_below = 1.5; },
      [](TrunkModelForm& form) { form.p1_minimum_mm = 0.0; },
      [](TrunkModelForm& form) { form.kind = ModelKind::Raw5; },
  };
  for (std::size_t k = 0; k < damages.size(); ++k) {
    auto form = hand_made_form();
    damages[k](form);
    EXPECT_FALSE(TrunkModel::create(form)) << k;
  }
}

}  // namespace
}  // namespace dts::classifier
