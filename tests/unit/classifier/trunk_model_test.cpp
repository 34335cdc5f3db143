// SPDX-License-Identifier: Apache-2.0
#include "classifier/trunk_model.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "classifier/trunk_model_parts.h"
#include "physics/body/person.h"
#include "unit/classifier/hand_made_model.h"

namespace dts::classifier {
namespace {

namespace flag = core::reach_flag;
namespace reason = core::class_reason;
using core::TrunkClass;

TrunkModel model(const TrunkModelForm& form = hand_made_form()) { return TrunkModel::create(form).value(); }
double deg_of(double sine) { return std::asin(sine) * 180.0 / std::numbers::pi; }
double sine_of(double deg) { return std::sin(deg * std::numbers::pi / 180.0); }

/// One network over the five features of the thesis, which separates the thirds of d1.
TrunkModelForm raw5_form() {
  TrunkModelForm form{.kind = ModelKind::Raw5, .p1_minimum_mm = 3.0, .p1_maximum_mm = 4.5, .general = {}, .facts = {}, .figures = {}};
  for (const auto feature : {ReachFeature::D1, ReachFeature::D2, ReachFeature::P1, ReachFeature::P2, ReachFeature::P3})
    form.general.inputs.push_back({feature, 0.0, feature == ReachFeature::D1 ? 0.35 : 10.0});
  form.general.networks = {thirds(5)};
  form.figures.validation_accuracy = 1.0;
  return form;
}

static_assert(kModerateFromDeg == physics::kModerateFromDeg && kMaximumFromDeg == physics::kMaximumFromDeg);

TEST(TrunkModel, Reaches_AreOfTheirClassOrRejectedWithTheReasons) {
  RecordProperty("requirement", "CLS-3");
  struct Row {
    double d2;  // of P1
    double p1_mm;
    std::uint16_t flags;
    TrunkClass expected;
    std::uint16_t reasons;
  };
  constexpr auto kNo = TrunkClass::Rejected;
  std::vector<Row> rows{{0.1, 3.5, 0, TrunkClass::Minor, 0},
                        {0.3, 3.5, 0, TrunkClass::Moderate, 0},
                        {0.55, 3.5, 0, TrunkClass::Maximum, 0},
                        {0.2, 3.5, 0, kNo, reason::kUnsure},  // at a border
                        {0.01, 3.5, flag::kMinor, TrunkClass::None, reason::kMinor},
                        {0.01, 3.5, 0, TrunkClass::None, 0},
                        {0.039, 3.5, flag::kMinor, TrunkClass::Minor, reason::kMinor},  // the rule for the arm alone is not sure
                        {0.3, 3.5, flag::kMinor, kNo, reason::kMinor | reason::kUnsure | reason::kDisagreement},
                        {0.203, 3.5, 0, TrunkClass::Moderate, 0},  // sure enough with all sensors, not with three
                        {0.3, 3.5, flag::kNoInitiation, TrunkClass::Moderate, 0},
                        {0.3, 2.099, 0, kNo, reason::kOutOfRange},  // 0.7 of the lightest
                        {0.3, 2.101, 0, TrunkClass::Moderate, 0},
                        {0.3, 6.074, 0, TrunkClass::Moderate, 0},
                        {0.3, 6.076, 0, kNo, reason::kOutOfRange},  // 1.35 of the heaviest
                        {0.749, 3.5, 0, TrunkClass::Maximum, 0},
                        {0.751, 3.5, 0, kNo, reason::kOutOfRange},  // a quarter of the range beyond its end
                        {-0.149, 3.5, 0, TrunkClass::None, 0},
                        {-0.151, 3.5, 0, kNo, reason::kOutOfRange}};
  for (const auto unfit : {flag::kDipOnly, flag::kTimeout, flag::kSaturated, flag::kImplausible, flag::kStoodUp, flag::kUntared})
    rows.push_back({0.3, 3.5, unfit, kNo, reason::kBadReach});
  // Too little deflection: the highest class is certain, and the doubt counts once.
  constexpr std::uint16_t kAtTheEnd = flag::kSaturated | flag::kSubstituted;
  rows.push_back({0.55, 3.5, kAtTheEnd, TrunkClass::Maximum, 0});
  rows.push_back({0.55, 3.5, kAtTheEnd | flag::kStoodUp, kNo, reason::kBadReach});
  rows.push_back({0.403, 3.5, kAtTheEnd | flag::kResumed, kNo, reason::kUnsure});
  for (const auto doubtful : {flag::kSubstituted, flag::kResumed, flag::kBaselineUncertain}) {
    rows.push_back({0.203, 3.5, doubtful, kNo, reason::kUnsure});
    rows.push_back({0.3, 3.5, doubtful, TrunkClass::Moderate, 0});
  }
  for (const Row& row : rows) {
    SCOPED_TRACE(testing::Message() << "d2 " << row.d2 << ", P1 " << row.p1_mm << ", flags " << row.flags);
    const auto movement = model().classify(reach_of(row.d2, row.p1_mm), row.flags);
    const auto guess = model().best_guess(reach_of(row.d2, row.p1_mm), row.flags);

    EXPECT_EQ(movement.trunk_class, row.expected);
    EXPECT_EQ(movement.reasons, row.reasons);
    EXPECT_NEAR(movement.probability[0] + movement.probability[1] + movement.probability[2], 1.0, 1e-12);
    EXPECT_NE(guess.trunk_class, TrunkClass::Rejected);
    if ((row.flags & flag::kMinor) != 0) {
      EXPECT_LE(guess.trunk_class, TrunkClass::Minor);
    }
  }
}

TEST(TrunkModel, Angle_IsClippedToItsInputsRangeAndHasTheIntervalOfItsClass) {
  const auto expect_angle = [](double relative_d2, double deg, double lowest_deg, double highest_deg) {
    const auto movement = model().classify(reach_of(relative_d2), 0);
    EXPECT_NEAR(movement.trunk_deg, deg, 1e-9);
    EXPECT_NEAR(movement.trunk_lo_deg, lowest_deg, 1e-9);
    EXPECT_NEAR(movement.trunk_hi_deg, highest_deg, 1e-9);
  };
  expect_angle(-0.1, 0.0, 0.0, 3.0);
  expect_angle(0.1, deg_of(0.15), deg_of(0.15) - 3.0, deg_of(0.15) + 3.0);
  expect_angle(0.3, deg_of(0.45), deg_of(0.45) - 6.0, deg_of(0.45) + 6.0);
  expect_angle(1.5, deg_of(0.9), deg_of(0.9) - 9.0, deg_of(0.9) + 9.0);
}

TEST(TrunkModel, SensorAtTheEndOfItsRange_AngleHasNoUpperLimit) {
  const auto usual = model().classify(reach_of(0.45), 0);
  const auto at_the_end = model().classify(reach_of(0.45), flag::kSaturated);

  EXPECT_EQ(at_the_end.trunk_deg, usual.trunk_deg);
  EXPECT_EQ(at_the_end.trunk_lo_deg, usual.trunk_lo_deg);
  EXPECT_LT(usual.trunk_hi_deg, 90.0);
  EXPECT_EQ(at_the_end.trunk_hi_deg, 90.0);
}

TEST(TrunkModel, RatioAtRestOutsideTheTraining_ClippedNotRejected) {
  auto form = hand_made_form();
  form.general.inputs.push_back({ReachFeature::RestRatio, -0.21, -0.19});
  form.general.networks = {thirds(2)};
  auto reach = reach_of(0.3);
  reach.rest_ratio = -0.4;

  EXPECT_EQ(model(form).classify(reach, 0).trunk_class, TrunkClass::Moderate);
}

TEST(TrunkModel, ArmAloneRule_IsSureFromItsLimitOn) {
  auto form = hand_made_form();
  form.arm_alone->none_from = model().arm_alone_probability(reach_of(0.03));

  EXPECT_EQ(model(form).classify(reach_of(0.03), 0).trunk_class, TrunkClass::None);
}

TEST(TrunkModel, NumberThatIsNotFinite_RejectedWithoutAPreference) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<core::ReachFeatures> unfit{{}, reach_of(0.3, 0.0)};
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity}) {
    for (double core::ReachFeatures::*member : {&core::ReachFeatures::p1_mm, &core::ReachFeatures::p2_mm, &core::ReachFeatures::p3_mm}) {
      unfit.push_back(reach_of(0.3));
      unfit.back().*member = bad;
    }
  }
  for (const auto& features : unfit) {
    const auto movement = model().classify(features, 0);
    EXPECT_EQ(movement.trunk_class, TrunkClass::Rejected);
    EXPECT_EQ(movement.reasons, reason::kBadReach);
    EXPECT_EQ(movement.probability, (Network::Outputs{1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0}));
    EXPECT_EQ(model().best_guess(features, 0).trunk_class, TrunkClass::Rejected);
  }
  EXPECT_EQ(TrunkModel{}.classify(reach_of(0.3), 0).reasons, reason::kBadReach);  // not trained
}

TEST(TrunkModel, ClassOutsideOfTheAnglesInterval_RejectedAsDisagreement) {
  auto form = hand_made_form();
  form.angle->sine.coefficients = {0.05, 0.0, 0.0};  // 3 degrees, whatever it sees
  EXPECT_EQ(model(form).classify(reach_of(0.55), 0).reasons, reason::kDisagreement);
  form.angle->sine.coefficients = {1.0, 0.0, 0.0};  // 90 degrees
  EXPECT_EQ(model(form).classify(reach_of(0.1), 0).reasons, reason::kDisagreement);
}

TEST(TrunkModel, Raw5_TellsAClassAndNoAngle) {
  const auto movement = model(raw5_form()).classify(reach_of(0.3), 0);  // d1 is 0.175 mm

  EXPECT_EQ(movement.trunk_class, TrunkClass::Moderate);
  EXPECT_EQ(movement.reasons, 0);
  EXPECT_TRUE(std::isnan(movement.trunk_deg));
  EXPECT_TRUE(std::isnan(model(raw5_form()).arm_alone_probability(reach_of(0.01))));
}

/// Geometry and the general angle together say how far somebody bends at the own maximum, which is what a reach as far as that gets.
TEST(TrunkModel, OwnMaximum_IsTheMeanOrWhatIsSeen) {
  const auto largest_deg = [](double max_d2, double flexion_deg, const TrunkModelForm& form = hand_made_form()) {
    const auto subject = calibrate_subject(std::vector(3, reach_of(max_d2)), flexion_deg).value();
    const auto movement = model(form).classify(reach_of(max_d2), 0, &subject);
    EXPECT_NE(movement.reasons & reason::kCalibrated, 0);
    return movement.trunk_deg;
  };
  const double seen_deg = deg_of(0.75);  // 48.6 degrees
  EXPECT_NEAR(largest_deg(0.5, 52.0), (seen_deg + 52.0) / 2.0, 1e-9);
  EXPECT_NEAR(largest_deg(0.5, 42.3), (seen_deg + 42.3) / 2.0, 1e-9);
  EXPECT_NEAR(largest_deg(0.5, 42.1), seen_deg, 1e-9);  // geometry asks for less than class 3
  EXPECT_NEAR(largest_deg(0.5, seen_deg + 17.9), seen_deg + 17.9 / 2.0, 1e-9);
  EXPECT_NEAR(largest_deg(0.5, seen_deg + 18.1), seen_deg, 1e-9);  // the two contradict each other
  auto without_angle = hand_made_form();
  without_angle.angle.reset();
  EXPECT_NEAR(largest_deg(0.5, 25.0, without_angle), 25.0, 1e-9);
}

TEST(TrunkModel, OwnScale_DecidesForSomebodyWhoBendsThePlateLess) {
  const auto subject = calibrate_subject(std::vector(3, reach_of(0.42)), 48.0).value();

  const auto movement = model().classify(reach_of(0.41), 0, &subject);

  EXPECT_EQ(movement.trunk_class, TrunkClass::Maximum);
  EXPECT_EQ(movement.reasons, reason::kCalibrated);
  EXPECT_NEAR(movement.trunk_deg, deg_of(0.41 / 0.42 * sine_of((deg_of(0.63) + 48.0) / 2.0)), 1e-9);
  EXPECT_EQ(model().classify(reach_of(0.19), 0, &subject).trunk_class, TrunkClass::Moderate);
  const auto bends_little = calibrate_subject(std::vector(3, reach_of(0.3)), 25.0).value();  // has no reach of class 3: the angle tells
  EXPECT_EQ(model().best_guess(reach_of(0.3), 0, &bends_little).trunk_class, TrunkClass::Moderate);
}

TEST(TrunkModel, ScaleThatIsNone_IsIgnored) {
  SubjectCalibration good = calibrate_subject(std::vector(3, reach_of(0.42)), 48.0).value();
  std::vector<SubjectCalibration> none(5, good);
  none[0] = {};
  none[1].max_d2_mm = 0.0;
  none[2].max_flexion_deg = 0.0;
  none[3].max_flexion_deg = 90.1;
  none[4].max_d2_mm = std::numeric_limits<double>::infinity();
  for (const auto& subject : none) EXPECT_EQ(model().classify(reach_of(0.3), 0, &subject).reasons, 0);
  auto form = hand_made_form();
  form.own_angle.reset();
  EXPECT_EQ(model(form).classify(reach_of(0.3), 0, &good).reasons, 0);
}

TEST(TrunkModelParts, Ensemble_IsTheMeanWithItsTemperature) {
  const auto says = [](double a, double b, double c) {  // whatever comes in
    return Network::create(1, 1, OutputKind::Softmax, {0.0, 0.0, 0.0, 0.0, 0.0, std::log(a), std::log(b), std::log(c)}).value();
  };
  const auto mean = probabilities({.inputs = {{}}, .networks = {says(0.1, 0.2, 0.7), says(0.3, 0.3, 0.4)}, .temperature = 2.0}, {});

  const double sum = std::sqrt(0.2) + std::sqrt(0.25) + std::sqrt(0.55);
  EXPECT_NEAR(mean[0], std::sqrt(0.2) / sum, 1e-12);
  EXPECT_NEAR(mean[1], std::sqrt(0.25) / sum, 1e-12);
  EXPECT_NEAR(mean[2], std::sqrt(0.55) / sum, 1e-12);
}

TEST(TrunkModelParts, Quadratic_IsAsByHand) {
  const ScaledInputs inputs{.values = {2.0, 3.0}};

  EXPECT_EQ(value_of(Quadratic{.inputs = {{}, {}}, .coefficients = {1.0, 10.0, 100.0, 0.5, 0.25, 0.125}}, inputs),
            1.0 + 20.0 + 300.0 + 0.5 * 4.0 + 0.25 * 6.0 + 0.125 * 9.0);
}

TEST(TrunkModelParts, ProbabilitiesOfAnAngle_AreANormalDistributionsAndNeverZero) {
  // A 90 % interval is 1.6449 deviations to each side, and never narrower than 0.1 degrees; here one deviation above a border.
  const auto narrow = probabilities(Angle{.deg = 15.25 + 0.1 / 1.6449, .lowest_deg = 15.3, .highest_deg = 15.35});
  const auto cut = probabilities(Angle{.deg = 42.2 + 50.0 / 1.6449, .lowest_deg = 42.2 + 50.0 / 1.6449 - 50.0, .highest_deg = 90.0});

  EXPECT_NEAR(narrow[0], 0.158655, 1e-6);
  EXPECT_NEAR(narrow[2], 1e-9, 1e-15);
  EXPECT_NEAR(cut[2], 1.0 - 0.158655, 1e-6);
}

struct FormRow {
  const char* message;  // of the refusal
  void (*change)(TrunkModelForm&);
};

/// A form with 13 own inputs, or less: features 1 to `count`.
void widen_own(TrunkModelForm& form, std::size_t count) {
  form.own->inputs.clear();
  for (std::size_t k = 1; k <= count; ++k) form.own->inputs.push_back({static_cast<ReachFeature>(k), 0.0, 1.0});
  form.own->networks = {thirds(std::min(count, Network::kMaxInputs))};
}

TEST(TrunkModelForm, PartsThatDoNotFit_RefusedByName) {
  const std::vector<FormRow> rows{
      {"its kind is unknown", [](auto& form) { form.kind = ModelKind{}; }},
      {"general has 0 features", [](auto& form) { form.general.inputs.clear(); }},
      {"own has 13 features", [](auto& form) { widen_own(form, 13); }},
      {"general has 0 networks", [](auto& form) { form.general.networks.clear(); }},
      {"general has 65 networks", [](auto& form) { form.general.networks.assign(65, thirds(1)); }},
      {"the number of a network's inputs",
       [](auto& form) {
         form.general.inputs.push_back({ReachFeature::D1, 0.0, 1.0});
       }},
      {"has d2_of_p1 twice", [](auto& form) { form.general.inputs.push_back(form.general.inputs[0]); }},
      {"range of d2_of_p1 is empty", [](auto& form) { form.general.inputs[0].maximum = form.general.inputs[0].minimum; }},
      {"must not use d2_of_own_max", [](auto& form) { form.general.inputs[0].feature = ReachFeature::OwnD2; }},
      {"must not use d2_of_own_max", [](auto& form) { form.angle->sine.inputs[0].feature = ReachFeature::OwnD2; }},
      {"arm_alone must not use d2_of_own_max", [](auto& form) { form.arm_alone->logit.inputs[0].feature = ReachFeature::OwnD2; }},
      {"temperature", [](auto& form) { form.general.temperature = 0.049; }},
      {"temperature", [](auto& form) { form.own->temperature = 20.1; }},
      {"angle has a wrong number", [](auto& form) { form.angle->sine.coefficients.push_back(0.0); }},
      {"not finite", [](auto& form) { form.angle->sine.coefficients[1] = std::numeric_limits<double>::infinity(); }},
      {"own_angle: a residual", [](auto& form) { form.own_angle->residual_deg[2] = 0.0; }},
      {"angle: a residual", [](auto& form) { form.angle->residual_deg[0] = 90.1; }},
      {"none_from", [](auto& form) { form.arm_alone->none_from = 0.499; }},
      {"none_from", [](auto& form) { form.arm_alone->none_from = 1.01; }},
      {"reject_below", [](auto& form) { form.reject_below = -0.01; }},
      {"reject_below", [](auto& form) { form.reject_below = 1.01; }},
      {"range of P1", [](auto& form) { form.p1_minimum_mm = 0.0; }},
      {"range of P1", [](auto& form) { form.p1_minimum_mm = form.p1_maximum_mm; }},
      {"range of P1", [](auto& form) { form.p1_maximum_mm = 1000.1; }},
      {"below 0.9: the training failed", [](auto& form) { form.figures.validation_accuracy = 0.899; }},
      {"the training failed", [](auto& form) { form.figures.validation_accuracy = 1.01; }},
      {"the training failed", [](auto& form) { form.figures.validation_accuracy = ModelFigures::kUnknown; }},
      {"raw5 must have the features", [](auto& form) { form.kind = ModelKind::Raw5; }},
      {"raw5 must have the features", [](auto& form) { form = raw5_form(), std::swap(form.general.inputs[3], form.general.inputs[4]); }},
      {"raw5 must have exactly one network", [](auto& form) { form = raw5_form(), form.general.networks.push_back(thirds(5)); }},
      {"raw5 must have only a network", [](auto& form) { form = raw5_form(), form.angle = hand_made_form().angle; }},
      {"raw5 must have only a network", [](auto& form) { form = raw5_form(), form.arm_alone = hand_made_form().arm_alone; }}};
  for (const FormRow& row : rows) {
    auto form = hand_made_form();
    row.change(form);
    const auto refused = TrunkModel::create(form);
    ASSERT_FALSE(refused) << row.message;
    EXPECT_THAT(refused.error().what, testing::HasSubstr(row.message));
  }
}

TEST(TrunkModelForm, PartsAtTheirLimits_Accepted) {
  for (const auto change :
       std::vector<void (*)(TrunkModelForm&)>{[](auto& form) { form = raw5_form(); }, [](auto& form) { widen_own(form, 12); },
                                              [](auto& form) { form.general.networks.assign(64, thirds(1)); },
                                              [](auto& form) { form.general.temperature = 0.05, form.own->temperature = 20.0; },
                                              [](auto& form) { form.angle->residual_deg[0] = 90.0, form.arm_alone->none_from = 1.0; },
                                              [](auto& form) { form.reject_below = 1.0, form.figures.validation_accuracy = 1.0; },
                                              [](auto& form) { form.reject_below = 0.0, form.figures.validation_accuracy = 0.9; }}) {
    auto form = hand_made_form();
    change(form);
    EXPECT_TRUE(TrunkModel::create(form)) << TrunkModel::create(form).error().what;
  }
}

}  // namespace
}  // namespace dts::classifier
