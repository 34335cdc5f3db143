// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/two_feet.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "physics/cop/sensed_plate.h"
#include "physics/cop/two_feet_fit.h"
#include "unit/physics/cop/constant_two_feet.h"
#include "unit/physics/floor_platform.h"

namespace dts::physics {
namespace {

using test::constant_form;
using test::floor_rig;

constexpr std::array<double, 4> kFlatMm{1.0, 1.0, 1.0, 1.0};

TwoFeetCorrection correction_of(const TwoFeetForm& form) { return TwoFeetCorrection::from_form(form).value(); }

TEST(TwoFeetTerms, AreAllProductsUpToTheDegree) {
  const auto four = TwoFeetPolynomial::terms_of({2.0, 3.0, 5.0, 7.0}, 4);
  EXPECT_THAT(std::vector(four.begin(), four.begin() + 11), testing::ElementsAre(1, 7, 49, 343, 5, 35, 245, 25, 175, 125, 3));
  EXPECT_THAT(std::vector(four.end() - 6, four.end()), testing::ElementsAre(9 * 2, 4, 4 * 7, 4 * 5, 4 * 3, 8)) << "35 terms";
}

TEST(TwoFeetTerms, WithoutTheWidthReachDegreeFour) {
  const auto three = TwoFeetPolynomial::terms_of({2.0, 3.0, 5.0, 7.0}, 3);
  EXPECT_THAT(std::vector(three.begin(), three.begin() + 6), testing::ElementsAre(1, 5, 25, 125, 625, 3));
  EXPECT_EQ(three.back(), 16.0);
}

TEST(TwoFeetCorrection, AddsToThePositionAndMultipliesTheLoad) {
  const CopEstimate point{.x_mm = 200.0, .y_mm = 230.0, .load_n = 600.0, .flags = 0};

  const CopEstimate corrected = correction_of(constant_form()).apply(point, kFlatMm, 200.0);

  EXPECT_EQ(corrected.x_mm, 202.0);
  EXPECT_EQ(corrected.y_mm, 227.0);
  EXPECT_NEAR(corrected.load_n, 660.0, 1e-9);
  EXPECT_EQ(corrected.flags, 0);
  EXPECT_TRUE(corrected.is_inside_calibration());
}

TEST(TwoFeetCorrection, WithoutTheWidthIsApproximate) {
  const CopEstimate point{.x_mm = 200.0, .y_mm = 230.0, .load_n = 600.0, .flags = cop_flag::kOutsideLoad};

  const CopEstimate corrected = correction_of(constant_form()).apply(point, kFlatMm, std::nullopt);

  EXPECT_NEAR(corrected.load_n, 720.0, 1e-9);
  EXPECT_EQ(cop_flags_text(corrected.flags), "outside_load|about");
}

TEST(TwoFeetCorrection, BeyondItsStancesIsThatOfTheNearestStance) {
  TwoFeetForm form = constant_form();
  form.with_width.x_mm = {};
  form.with_width.x_mm[1] = 1.0;  // the width, in standard deviations
  const TwoFeetCorrection correction = correction_of(form);
  const CopEstimate point{.x_mm = 200.0, .y_mm = 230.0, .load_n = 600.0, .flags = 0};

  const CopEstimate widest = correction.apply(point, kFlatMm, 280.0);
  const CopEstimate wider = correction.apply(point, kFlatMm, 400.0);

  EXPECT_EQ(wider.x_mm, widest.x_mm);
  EXPECT_EQ(widest.flags, 0);
  EXPECT_EQ(cop_flags_text(wider.flags), "outside_two_feet");
  EXPECT_FALSE(wider.is_inside_calibration());
  for (const CopEstimate& beyond :
       {CopEstimate{150.0, 230.0, 600.0, 0}, CopEstimate{200.0, 290.0, 600.0, 0}, CopEstimate{200.0, 230.0, 1001.0, 0}}) {
    EXPECT_EQ(correction.apply(beyond, kFlatMm, 200.0).flags, cop_flag::kOutsideTwoFeet);
  }
}

TEST(TwoFeetCorrection, DeflectionBeyondTheTravel_IsFlagged) {
  const TwoFeetCorrection correction = correction_of(constant_form());
  const CopEstimate point{.x_mm = 200.0, .y_mm = 230.0, .load_n = 600.0, .flags = 0};

  EXPECT_EQ(correction.apply(point, std::array{5.0, 1.0, 1.0, 1.0}, 200.0).flags, 0);
  EXPECT_EQ(cop_flags_text(correction.apply(point, std::array{1.0, 1.0, 1.0, 5.001}, 200.0).flags), "outside_travel");
}

TEST(TwoFeetCorrection, WithoutContactChangesNothing) {
  const CopEstimate corrected = correction_of(constant_form()).apply({}, kFlatMm, 200.0);

  EXPECT_EQ(corrected.flags, cop_flag::kNoContact);
  EXPECT_TRUE(std::isnan(corrected.x_mm) && std::isnan(corrected.y_mm) && std::isnan(corrected.load_n));
}

TEST(TwoFeetCorrection, HugeCoefficients_GiveFiniteLoads) {
  TwoFeetForm form = constant_form();
  form.with_width.log_load[0] = 1e30;

  EXPECT_TRUE(std::isfinite(correction_of(form).apply({200.0, 230.0, 600.0, 0}, kFlatMm, 200.0).load_n));
}

TEST(TwoFeetCorrection, CoversPositionsOfItsStancesOnly) {
  const TwoFeetCorrection correction = correction_of(constant_form());

  EXPECT_TRUE(correction.covers_position({275.0, 145.0, 5000.0, 0}));
  EXPECT_FALSE(correction.covers_position({275.1, 145.0, 600.0, 0}));
  EXPECT_FALSE(correction.covers_position({275.0, 144.9, 600.0, 0}));
  EXPECT_FALSE(correction.covers_position({}));
}

TEST(TwoFeetCorrection, BadForms_AreRejected) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto is_rejected = [](auto change) {
    TwoFeetForm form = constant_form();
    change(form);
    return !TwoFeetCorrection::from_form(form);
  };
  EXPECT_FALSE(is_rejected([](TwoFeetForm&) {}));
  EXPECT_TRUE(is_rejected([&](TwoFeetForm& form) { form.with_width.x_mm[34] = nan; }));
  EXPECT_TRUE(is_rejected([&](TwoFeetForm& form) { form.without_width.y_mm[0] = HUGE_VAL; }));
  EXPECT_TRUE(is_rejected([&](TwoFeetForm& form) { form.without_width.log_load[3] = nan; }));
  EXPECT_TRUE(is_rejected([](TwoFeetForm& form) { form.with_width.features[3].sd = 0.0; }));
  EXPECT_TRUE(is_rejected([&](TwoFeetForm& form) { form.with_width.features[0].mean = nan; }));
  EXPECT_TRUE(is_rejected([](TwoFeetForm& form) { form.without_width.features[1].range = {2.0, 1.0}; }));
  EXPECT_TRUE(is_rejected([](TwoFeetForm& form) { form.without_width.features[1].range.highest = 1e6; }));
  EXPECT_TRUE(is_rejected([](TwoFeetForm& form) { form.without_width.feature_count = 4; }));
  EXPECT_TRUE(is_rejected([](TwoFeetForm& form) { form.travel_mm = 0.0; }));
  EXPECT_TRUE(is_rejected([&](TwoFeetForm& form) { form.travel_mm = nan; }));
}

TEST(TwoFeetWeight, DiffersByMoreThanFivePercent_IsDoubtful) {
  EXPECT_FALSE(is_load_doubtful(735.0, 700.0));
  EXPECT_TRUE(is_load_doubtful(736.0, 700.0));
  EXPECT_FALSE(is_load_doubtful(665.0, 700.0));
  EXPECT_TRUE(is_load_doubtful(664.0, 700.0));
}

TEST(TwoFeetStances, StandOnThePlateAsTheSheetSays) {
  const Plate plate = test::steel_plate();
  const auto stances = two_feet_stances(plate, 200, 1);

  ASSERT_EQ(stances.size(), 200U);
  for (const TwoFeetStance& stance : stances) {
    EXPECT_TRUE(Interval({110.0, 260.0}).contains(stance.width_mm));
    EXPECT_LE(std::abs(stance.stated_width_mm - stance.width_mm), kWidthErrorMm);
    ASSERT_EQ(stance.positions.size(), 7U);
    double weight_n = 0.0;
    for (const PlateLoad& load : stance.positions.front().loads) weight_n += load.force.value;
    EXPECT_TRUE(Interval({45.0 * 9.8, 110.0 * 9.8}).contains(weight_n));
    const Point mean = stance.positions.front().centre;
    for (const CopTrial& position : stance.positions) {
      EXPECT_EQ(position.loads.size(), 6U);
      EXPECT_LE(std::abs(position.centre.x.value - mean.x.value), 16.0 + 4.0) << "toe-out adds to the side";
      EXPECT_LE(std::abs(position.centre.y.value - mean.y.value), 20.0 + 4.0);
      double sum_n = 0.0;
      for (const PlateLoad& load : position.loads) {
        EXPECT_GE(load.force.value, 0.0);
        EXPECT_GE(load.area.centre.x.value - 0.5 * load.area.width.value, -1e-9);
        EXPECT_LE(load.area.centre.x.value + 0.5 * load.area.width.value, plate.a.value + 1e-9);
        EXPECT_GE(load.area.centre.y.value - 0.5 * load.area.height.value, -1e-9);
        EXPECT_LE(load.area.centre.y.value + 0.5 * load.area.height.value, plate.b.value + 1e-9);
        sum_n += load.force.value;
      }
      EXPECT_NEAR(sum_n, weight_n, 1e-9 * weight_n) << "sway moves the load, it does not change it";
    }
  }
}

TEST(TwoFeetStances, OfOneSeed_AreTheSame) {
  const auto centres = [](std::uint64_t seed) {
    std::vector<double> values;
    for (const TwoFeetStance& stance : two_feet_stances(test::steel_plate(), 5, seed)) values.push_back(stance.positions[3].centre.x.value);
    return values;
  };
  EXPECT_EQ(centres(7), centres(7));
  EXPECT_NE(centres(7), centres(8));
}

/// Fitted once for all tests: it takes a second.
const TwoFeetCorrection& fitted() {
  static const TwoFeetCorrection correction =
      TwoFeetCorrection::from_form(fit_two_feet(CopMethod::Poly3, floor_rig(10.75), 400).value().form).value();
  return correction;
}

struct Errors {
  double load_percent = 0.0;  ///< Mean of the sizes.
  double ml_percent = 0.0;    ///< Of the size of the sway.
  double ap_percent = 0.0;
};

/// Judges `apply` with stances that the fit has not seen.
template <class Apply>
Errors judge(Apply apply) {
  const RigModel rig = floor_rig(10.75);
  const auto plate = SensedPlate::create(rig, PlateBehaviour::Stiffening).value();
  const auto points = CopEstimator::from_model(CopMethod::Poly3, rig).value();
  const auto stances = two_feet_stances(rig.plate, 60, 99);
  Errors errors;
  for (const TwoFeetStance& stance : stances) {
    const CopTrial& mean = stance.positions.front();
    double ml = 0.0, ml_truth = 0.0, ap = 0.0, ap_truth = 0.0;
    CopEstimate first;
    for (const CopTrial& position : stance.positions) {
      const auto deflection_mm = plate.deflection_mm(position.loads);
      const CopEstimate estimate = apply(points.estimate(deflection_mm), deflection_mm, stance.stated_width_mm);
      if (&position == &mean) first = estimate;
      const double truth_ml = position.centre.x.value - mean.centre.x.value;
      const double truth_ap = position.centre.y.value - mean.centre.y.value;
      ml += (estimate.x_mm - first.x_mm) * truth_ml;
      ap += (estimate.y_mm - first.y_mm) * truth_ap;
      ml_truth += truth_ml * truth_ml;
      ap_truth += truth_ap * truth_ap;
    }
    double weight_n = 0.0;
    for (const PlateLoad& load : mean.loads) weight_n += load.force.value;
    errors.load_percent += 100.0 * std::abs(first.load_n / weight_n - 1.0) / 60.0;
    errors.ml_percent += 100.0 * std::abs(ml / ml_truth - 1.0) / 60.0;
    errors.ap_percent += 100.0 * std::abs(ap / ap_truth - 1.0) / 60.0;
  }
  return errors;
}

TEST(FitTwoFeet, CorrectsLoadAndSwayOfUnseenPeople) {
  const Errors before = judge([](const CopEstimate& point, const auto&, double) { return point; });
  const Errors with_width = judge([](const CopEstimate& point, const auto& w, double width) { return fitted().apply(point, w, width); });
  const Errors without = judge([](const CopEstimate& point, const auto& w, double) { return fitted().apply(point, w, std::nullopt); });

  EXPECT_GT(before.load_percent, 6.0);  // sheet two-feet: 8.2, 4.0 and 4.8 %
  EXPECT_GT(before.ml_percent, 3.0);
  EXPECT_GT(before.ap_percent, 3.0);
  EXPECT_LT(with_width.load_percent, 1.5);
  EXPECT_LT(with_width.ml_percent, 1.2);
  EXPECT_LT(with_width.ap_percent, 2.0);
  EXPECT_LT(without.load_percent, 3.5);
  EXPECT_LT(without.ml_percent, 1.5);
  EXPECT_LT(without.ap_percent, 4.0);
  EXPECT_LT(with_width.load_percent, without.load_percent);
}

TEST(FitTwoFeet, KnowsItsStancesAndTheSensors) {
  const TwoFeetForm& form = fitted().form();

  EXPECT_EQ(form.travel_mm, 5.0) << "the curve reaches farther, the thesis's sensors do not";
  EXPECT_NEAR(form.with_width.features[3].range.lowest, 90.0, 5.0);
  EXPECT_NEAR(form.with_width.features[3].range.highest, 280.0, 5.0);
  EXPECT_TRUE(fitted().covers_position({215.0, 215.0, 600.0, 0}));
  EXPECT_FALSE(fitted().covers_position({115.0, 215.0, 600.0, 0})) << "on the left foot";
}

TEST(FitTwoFeet, SensorsOfLessTravel_LimitIt) {
  RigModel rig = floor_rig(10.75);
  rig.sensors[2].unloaded_gap = {7.0};  // the curve begins at 4 mm

  EXPECT_NEAR(fit_two_feet(CopMethod::Poly3, rig, 60).value().form.travel_mm, 3.0, 1e-12);
}

TEST(FitTwoFeet, NamesThePeopleWhoAreTooHeavyForTheSensors) {
  const auto thin = fit_two_feet(CopMethod::Poly3, floor_rig(10.75), 400).value();
  RigModel rig = floor_rig(10.75);
  rig.plate.h = {4.0};

  ASSERT_TRUE(thin.too_heavy_n);
  EXPECT_NEAR(*thin.too_heavy_n / 9.8, 84.0, 6.0) << "sheet two-feet";
  EXPECT_FALSE(fit_two_feet(CopMethod::Poly3, rig, 60).value().too_heavy_n);
}

TEST(FitTwoFeet, PlateTooSmallForFeet_IsRejected) {
  RigModel rig = floor_rig(10.75);
  rig.plate.a = rig.plate.b = {180.0};
  for (std::size_t k = 0; k < rig.sensors.size(); ++k) rig.sensors[k].position = test::at(k % 2 == 0 ? 40 : 140, k < 2 ? 40 : 140);

  const auto form = fit_two_feet(CopMethod::Poly3, rig, 60);

  ASSERT_FALSE(form);
  EXPECT_THAT(form.error().what, testing::HasSubstr("is too small for a person on two feet"));
}

TEST(FitTwoFeet, Progress_RisesToOne) {
  double last = 0.0;
  bool is_rising = true;
  ASSERT_TRUE(fit_two_feet(CopMethod::Thesis, floor_rig(10.75), 60, [&](double part) {
    is_rising = is_rising && part > last;
    last = part;
  }));
  EXPECT_TRUE(is_rising);
  EXPECT_EQ(last, 1.0);
}

}  // namespace
}  // namespace dts::physics
