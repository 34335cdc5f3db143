// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "lab/steadiness/scores.h"

namespace dts::lab::steadiness {
namespace {

using pattern::Answer;
using pattern::classify;
using posturography::Measure;
using ::testing::HasSubstr;

/// `people` subjects with two rows of each label; label "b" is `shift` standard deviations (of the logarithm) above "a".
Samples made_samples(int people, double shift, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Samples samples{.measures = {Measure::Mvelo, Measure::Rdist, Measure::EllAngle}, .values = {}, .labels = {}, .subjects = {}};
  for (int person = 0; person < people; ++person) {
    for (int row = 0; row < 4; ++row) {
      posturography::Measures values;
      values.set(Measure::Mvelo, 8.0 * std::exp(0.2 * (normal(random) + (row % 2 == 0 ? 0.0 : shift))));
      values.set(Measure::Rdist, 5.0 * std::exp(0.3 * normal(random)));
      values.set(Measure::EllAngle, 40.0 * normal(random));
      samples.values.push_back(values);
      samples.labels.emplace_back(row % 2 == 0 ? "a" : "b");
      samples.subjects.push_back("S" + std::to_string(person));
    }
  }
  return samples;
}

Evaluation evaluated(const Samples& samples, const std::vector<Rival>& rivals = {}) {
  const auto evaluation = evaluate_left_out(samples, rivals, [](double) {});
  EXPECT_TRUE(evaluation) << evaluation.error().what;
  return evaluation.value_or(Evaluation{});
}

TEST(Discriminant, SeparableLabels_AreTold) {
  const Samples samples = made_samples(12, 8.0, 1);

  const auto discriminant = fit_all(samples);

  ASSERT_TRUE(discriminant) << discriminant.error().what;
  EXPECT_THAT(discriminant->classes, ::testing::ElementsAre("a", "b"));
  EXPECT_TRUE(discriminant->predictors[0].is_logarithmic);
  EXPECT_FALSE(discriminant->predictors[2].is_logarithmic) << "angles are negative too";
  for (std::size_t row = 0; row < samples.labels.size(); ++row) {
    const Answer answer = classify(*discriminant, samples.values[row]);
    ASSERT_TRUE(answer.best);
    EXPECT_EQ(discriminant->classes[*answer.best], samples.labels[row]);
    EXPECT_NEAR(answer.probabilities[0] + answer.probabilities[1], 1.0, 1e-12);
    EXPECT_TRUE(answer.outside.empty());
  }
}

// Two balanced classes in one dimension, no shrinking (a multiple of the identity already): the border lies in the middle of the means.
TEST(Discriminant, OneMeasure_HasItsBorderInTheMiddle) {
  Samples samples{.measures = {Measure::EllAngle}, .values = {}, .labels = {}, .subjects = {}};
  for (const double angle : {-12.0, -10.0, -8.0, 18.0, 20.0, 22.0}) {
    samples.values.emplace_back().set(Measure::EllAngle, angle);
    samples.labels.emplace_back(angle < 0.0 ? "left" : "right");
    samples.subjects.emplace_back();
  }
  const auto discriminant = fit_all(samples);
  ASSERT_TRUE(discriminant);

  const auto probability_right = [&](double angle) {
    posturography::Measures values;
    values.set(Measure::EllAngle, angle);
    return classify(*discriminant, values).probabilities.at(1);
  };
  EXPECT_NEAR(probability_right(5.0), 0.5, 1e-9);
  EXPECT_LT(probability_right(4.0), 0.5);
  EXPECT_GT(probability_right(6.0), 0.5);
  // Pooled variance 16 / (6 - 2) = 4: log odds at x are (20 + 10) (x - 5) / 4 = 7.5 at 6, but for the floor of the variance.
  EXPECT_NEAR(std::log(probability_right(6.0) / (1.0 - probability_right(6.0))), 7.5, 0.01);
}

TEST(Discriminant, MoreMeasuresThanRows_StayFinite) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  Samples samples;
  for (std::size_t k = 0; k < 40; ++k) samples.measures.push_back(static_cast<Measure>(k));
  for (int row = 0; row < 8; ++row) {
    samples.values.emplace_back();
    for (const Measure measure : samples.measures) samples.values.back().set(measure, 1.0 + std::abs(normal(random)));
    samples.labels.emplace_back(row % 2 == 0 ? "a" : "b");
    samples.subjects.emplace_back();
  }

  const auto discriminant = fit_all(samples);

  ASSERT_TRUE(discriminant) << discriminant.error().what;
  EXPECT_GT(discriminant->shrinkage, 0.05);
  EXPECT_TRUE(classify(*discriminant, samples.values[0]).best.has_value());
}

TEST(Discriminant, WhatItCannotTell_ItDoesNotTell) {
  const Samples samples = made_samples(6, 3.0, 2);
  const auto discriminant = fit_all(samples);
  ASSERT_TRUE(discriminant);

  posturography::Measures values = samples.values[0];
  values.set(Measure::Mvelo, 1000.0);
  EXPECT_THAT(classify(*discriminant, values).outside, ::testing::ElementsAre(Measure::Mvelo));
  values.set(Measure::Mvelo, 0.0);
  EXPECT_FALSE(classify(*discriminant, values).best.has_value()) << "no logarithm";
  EXPECT_FALSE(classify(*discriminant, {}).best.has_value());

  Samples one_label = samples;
  for (std::string& label : one_label.labels) label = "a";
  EXPECT_FALSE(fit_all(one_label));
  Samples constant = samples;
  for (auto& row : constant.values) row = samples.values[0];
  EXPECT_FALSE(fit_all(constant));
}

TEST(Ranking, Auc_CountsPairs) {
  const std::vector<double> scores{0.1, 0.4, 0.35, 0.8, 0.4};
  const std::vector<bool> is_positive{false, false, true, true, true};
  // Pairs (positive, negative): 0.35 > 0.1, 0.35 < 0.4, 0.8 twice, 0.4 > 0.1, 0.4 = 0.4.
  EXPECT_NEAR(Ranking(scores, is_positive).auc().value(), (1.0 + 0.0 + 2.0 + 1.0 + 0.5) / 6.0, 1e-12);
  // Without the first case: 0.35 < 0.4, 0.8 > 0.4, 0.4 = 0.4; the second positive one counts twice.
  EXPECT_NEAR(Ranking(scores, is_positive).auc(std::vector{0.0, 1.0, 1.0, 2.0, 1.0}).value(), 2.5 / 4.0, 1e-12);
  EXPECT_FALSE(Ranking(scores, std::vector<bool>(5, true)).auc());
}

TEST(Ranking, EqualError_IsWhereBothSharesMeet) {
  // Limit between 3 and 4: 2 of 3 positive and 2 of 3 negative are right.
  EXPECT_NEAR(Ranking(std::vector{1.0, 2.0, 5.0, 3.0, 4.0, 6.0}, {false, false, false, true, true, true}).equal_error_correct(), 2.0 / 3.0,
              1e-12);
  EXPECT_EQ(Ranking(std::vector{1.0, 2.0}, {false, true}).equal_error_correct(), 1.0);
  EXPECT_EQ(Ranking(std::vector{1.0, 2.0}, {true, true}).equal_error_correct(), 0.5);
}

TEST(Calibration, Slope_IsOneOverTheExaggeration) {
  // 3 of 4 and 1 of 4: the log odds are +-log(3). Probabilities with twice these log odds (9 : 1) have half the slope.
  std::vector<double> right;
  std::vector<double> exaggerated;
  std::vector<bool> is_positive;
  for (int k = 0; k < 8; ++k) {
    const bool is_high = k < 4;
    is_positive.push_back(is_high ? k != 0 : k == 4);
    right.push_back(is_high ? 0.75 : 0.25);
    exaggerated.push_back(is_high ? 0.9 : 0.1);
  }
  EXPECT_NEAR(calibration_slope(right, is_positive).value(), 1.0, 1e-6);
  EXPECT_NEAR(calibration_slope(exaggerated, is_positive).value(), 0.5, 1e-6);
  EXPECT_FALSE(calibration_slope(std::vector{0.2, 0.8}, {false, true})) << "separated";
  EXPECT_FALSE(calibration_slope(std::vector{0.5, 0.5}, {false, true})) << "constant";
}

TEST(Evaluation, SeparableLabels_AreTold) {
  const Evaluation evaluation = evaluated(made_samples(12, 8.0, 1));

  EXPECT_EQ(evaluation.rows, 48U);
  EXPECT_EQ(evaluation.people.named, 12U);
  EXPECT_FALSE(evaluation.people.is_label_of_person);
  EXPECT_GT(evaluation.accuracy, 0.95);
  EXPECT_EQ(evaluation.commonest_share, 0.5);
  EXPECT_NEAR(evaluation.brier_base, 0.25, 1e-12);
  EXPECT_EQ(evaluation.left_out.model.auc.value, 1.0);
  EXPECT_EQ(evaluation.left_out.best_measure, "MVELO");
  EXPECT_EQ(evaluation.left_out.best_chosen_by, 12U);
  EXPECT_EQ(evaluation.left_out.best.gain.value, 0.0);
  EXPECT_FALSE(evaluation.is_better_than_one_measure()) << "one measure holds all";
  EXPECT_LE(evaluation.permutation_p, 0.01);
  EXPECT_EQ(evaluation.verdict, Verdict::Told);
  EXPECT_FALSE(evaluation.is_of_too_few());
}

TEST(Evaluation, RandomLabels_AreNotTold) {
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Evaluation evaluation = evaluated(made_samples(12, 0.0, seed));
    EXPECT_EQ(evaluation.verdict, Verdict::NotTold) << seed << ": " << evaluation.left_out.model.auc.value;
    EXPECT_GT(evaluation.permutation_p, 0.01) << seed;
    EXPECT_TRUE(evaluation.ten_fold || evaluation.left_out.model.auc.value >= 0.65) << seed;
  }
}

/// People of two groups with three trials each; the group shifts one measure by `shift` SD between people.
struct Groups {
  Samples samples;
  std::vector<double> age;  ///< Shows the group as well as `age_shift` SD.
};

Groups made_groups(int people, double shift, double age_shift, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Groups made{.samples = {.measures = {Measure::Mvelo, Measure::Rdist, Measure::AreaSw}, .values = {}, .labels = {}, .subjects = {}},
              .age = {}};
  for (int person = 0; person < people; ++person) {
    const bool is_b = person % 2 == 1;
    const double own[3] = {normal(random) + (is_b ? shift : 0.0), normal(random), normal(random)};
    const double age = 50.0 + 10.0 * (normal(random) + (is_b ? age_shift : 0.0));
    for (int row = 0; row < 3; ++row) {
      made.samples.values.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) made.samples.values.back().set(made.samples.measures[k], std::exp(own[k] + 0.1 * normal(random)));
      made.samples.labels.emplace_back(is_b ? "b" : "a");
      made.samples.subjects.push_back("S" + std::to_string(person));
      made.age.push_back(age);
    }
  }
  return made;
}

/// Each person sways in an own way, and the label is drawn by person: rows of one person on both sides would show it.
TEST(Evaluation, PeopleAreLeftOutWhole) {
  RecordProperty("requirement", "SWAY-9");
  Groups made = made_groups(12, 0.0, 0.0, 9);

  const Evaluation by_person = evaluated(made.samples);
  EXPECT_TRUE(by_person.people.is_label_of_person);
  EXPECT_EQ(by_person.verdict, Verdict::NotTold) << by_person.accuracy;

  made.samples.subjects.assign(made.samples.subjects.size(), "");
  const Evaluation by_row = evaluated(made.samples);
  EXPECT_EQ(by_row.rows_without, 36U);
  EXPECT_EQ(by_row.people.named, 0U);
  EXPECT_TRUE(by_row.is_of_too_few());
  EXPECT_EQ(by_row.verdict, Verdict::NotTold) << "nobody knows how many people these are";
  EXPECT_GT(by_row.accuracy, by_person.accuracy) << "which flatters";
}

TEST(Evaluation, IntervalCountsPeople_NotTrials) {
  const Groups made = made_groups(30, 1.2, 0.0, 4);
  const Interval interval = evaluated(made.samples).left_out.model.auc;

  EXPECT_LT(interval.low, interval.value);
  EXPECT_LT(interval.value, interval.high);
  // SD of an AUC of 0.8 of 15 and 15 people (Hanley & McNeil 1982): 0.083. With 45 and 45 independent trials it would be 0.047.
  EXPECT_GT(interval.high - interval.low, 0.2);
}

TEST(Evaluation, AgeThatTellsBetter_IsNamed) {
  const Groups made = made_groups(60, 0.7, 2.5, 5);

  const Evaluation evaluation = evaluated(made.samples, {{.name = "age", .columns = {made.age}}});

  EXPECT_EQ(evaluation.verdict, Verdict::ToldByOther);
  EXPECT_EQ(evaluation.told_by, "age");
  EXPECT_LT(evaluation.deciding().rivals.at(0).gain.high, 0.0);
}

TEST(Evaluation, AgeThatTellsLess_DoesNotMatter) {
  const Groups made = made_groups(60, 2.5, 0.7, 5);
  std::vector<double> drawn = made.age;
  std::ranges::reverse(drawn);

  const Evaluation evaluation = evaluated(made.samples, {{.name = "age", .columns = {made.age}}, {.name = "luck", .columns = {drawn}}});

  EXPECT_EQ(evaluation.verdict, Verdict::Told);
  ASSERT_EQ(evaluation.left_out.rivals.size(), 3U) << "each alone, and both together";
  EXPECT_EQ(evaluation.left_out.rivals.at(2).name, "age with luck");
}

TEST(Evaluation, FactThatDefinesTheLabel_IsNotCompared) {
  const Groups made = made_groups(30, 2.5, 100.0, 5);

  const Evaluation evaluation = evaluated(made.samples, {{.name = "age", .columns = {made.age}}});

  EXPECT_THAT(evaluation.definitions, ::testing::ElementsAre("age"));
  EXPECT_THAT(evaluation.left_out.rivals, ::testing::IsEmpty());
  EXPECT_EQ(evaluation.verdict, Verdict::Told);
}

TEST(Evaluation, GroupsThatWereNotComparedByAge_AreNotTold) {
  RecordProperty("requirement", "SWAY-9");
  const Groups made = made_groups(60, 2.5, 0.7, 5);
  const std::vector<double> drawn(made.age.rbegin(), made.age.rend());

  const Evaluation alone = evaluated(made.samples);
  EXPECT_GT(alone.deciding().model.auc.low, 0.5);
  EXPECT_LE(alone.permutation_p, Evaluation::kMostP);
  EXPECT_FALSE(alone.is_age_excluded);
  EXPECT_EQ(alone.verdict, Verdict::NotTold);
  EXPECT_EQ(evaluated(made.samples, {{.name = "luck", .columns = {drawn}}}).verdict, Verdict::NotTold) << "age is what must be compared";
}

TEST(Evaluation, SameInput_HasTheSameResult) {
  const Groups made = made_groups(20, 0.5, 0.5, 6);
  const Evaluation once = evaluated(made.samples);
  const Evaluation again = evaluated(made.samples);
  EXPECT_EQ(once.permutation_p, again.permutation_p);
  EXPECT_EQ(once.deciding().model.auc.low, again.deciding().model.auc.low);
}

TEST(Evaluation, ThreeLabels_AreEachComparedWithTheRest) {
  Groups made = made_groups(45, 0.0, 0.0, 7);
  for (std::size_t row = 0; row < made.samples.labels.size(); ++row) {
    const std::size_t group = (row / 3) % 3;
    made.samples.labels[row] = std::string(1, static_cast<char>('a' + group));
    made.samples.values[row].set(Measure::Mvelo, std::exp(3.0 * static_cast<double>(group) + 0.01 * made.age[row]));
  }

  std::vector<double> drawn = made.age;
  std::ranges::sort(drawn);

  const Evaluation evaluation = evaluated(made.samples, {{.name = "age", .columns = {drawn}}});

  EXPECT_EQ(evaluation.verdict, Verdict::Told);
  EXPECT_NEAR(evaluation.left_out.model.auc.value, 1.0, 0.02);
  EXPECT_NEAR(evaluation.brier_base, 1.0 / 3.0, 1e-12);
  EXPECT_FALSE(evaluation.left_out.model.slope) << "defined for two labels";
}

}  // namespace
}  // namespace dts::lab::steadiness
