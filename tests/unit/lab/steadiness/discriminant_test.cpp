// SPDX-License-Identifier: Apache-2.0
#include "lab/steadiness/discriminant.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "lab/steadiness/discriminant_evaluation.h"
#include "lab/steadiness/steadiness_model.h"

namespace dts::lab::steadiness {
namespace {

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

std::vector<std::size_t> all_of(const Samples& samples) {
  std::vector<std::size_t> rows(samples.labels.size());
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

Evaluation evaluated(const Samples& samples) {
  const auto evaluation = evaluate_left_out(samples, [](double) {});
  EXPECT_TRUE(evaluation) << evaluation.error().what;
  return evaluation.value_or(Evaluation{});
}

TEST(Discriminant, SeparableLabels_AreTold) {
  const Samples samples = made_samples(12, 8.0, 1);

  const auto discriminant = fit(samples, all_of(samples));

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
  const auto discriminant = fit(samples, all_of(samples));
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

  const auto discriminant = fit(samples, all_of(samples));

  ASSERT_TRUE(discriminant) << discriminant.error().what;
  EXPECT_GT(discriminant->shrinkage, 0.05);
  EXPECT_TRUE(classify(*discriminant, samples.values[0]).best.has_value());
}

TEST(Discriminant, WhatItCannotTell_ItDoesNotTell) {
  const Samples samples = made_samples(6, 3.0, 2);
  const auto discriminant = fit(samples, all_of(samples));
  ASSERT_TRUE(discriminant);

  posturography::Measures values = samples.values[0];
  values.set(Measure::Mvelo, 1000.0);
  EXPECT_THAT(classify(*discriminant, values).outside, ::testing::ElementsAre(Measure::Mvelo));
  values.set(Measure::Mvelo, 0.0);
  EXPECT_FALSE(classify(*discriminant, values).best.has_value()) << "no logarithm";
  EXPECT_FALSE(classify(*discriminant, {}).best.has_value());

  Samples one_label = samples;
  for (std::string& label : one_label.labels) label = "a";
  EXPECT_FALSE(fit(one_label, all_of(one_label)));
  Samples constant = samples;
  for (auto& row : constant.values) row = samples.values[0];
  EXPECT_FALSE(fit(constant, all_of(constant)));
}

TEST(Evaluation, Wilson_IsAsInTheTables) {
  // 8 of 10: 49.0 .. 94.3 %; 0 of 10: 0 .. 27.8 % (Brown, Cai & DasGupta 2001).
  EXPECT_NEAR(wilson_interval(0.8, 10.0).low, 0.4902, 1e-4);
  EXPECT_NEAR(wilson_interval(0.8, 10.0).high, 0.9433, 1e-4);
  EXPECT_NEAR(wilson_interval(0.0, 10.0).low, 0.0, 1e-12);
  EXPECT_NEAR(wilson_interval(0.0, 10.0).high, 0.2775, 1e-4);
  EXPECT_EQ(wilson_interval(0.0, 0.0).high, 1.0);
}

TEST(Evaluation, SeparableLabels_AreBetterThanChance) {
  const Evaluation evaluation = evaluated(made_samples(12, 8.0, 1));

  EXPECT_EQ(evaluation.rows, 48U);
  EXPECT_EQ(evaluation.subjects, 12U);
  EXPECT_FALSE(evaluation.is_label_of_person);
  EXPECT_EQ(evaluation.independent, 48.0);
  EXPECT_GT(evaluation.accuracy, 0.95);
  EXPECT_EQ(evaluation.commonest_share, 0.5);
  EXPECT_TRUE(evaluation.is_better_than_chance());
  EXPECT_FALSE(evaluation.is_of_too_few());
}

TEST(Evaluation, RandomLabels_AreNoBetterThanChance) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U, 6U, 7U, 8U}) {
    const Evaluation evaluation = evaluated(made_samples(12, 0.0, seed));
    EXPECT_LT(std::abs(evaluation.accuracy - 0.5), 0.3) << seed;
    EXPECT_FALSE(evaluation.is_better_than_chance()) << seed << ": " << evaluation.accuracy;
  }
}

/// Each person sways in an own way, and the label is drawn by person: rows of one person on both sides would tell it apart.
TEST(Evaluation, PeopleAreLeftOutWhole_AndCounted) {
  RecordProperty("requirement", "SWAY-9");
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  Samples samples{.measures = {Measure::Mvelo, Measure::Rdist, Measure::AreaSw}, .values = {}, .labels = {}, .subjects = {}};
  for (int person = 0; person < 10; ++person) {
    const double own[3] = {normal(random), normal(random), normal(random)};
    for (int row = 0; row < 8; ++row) {
      samples.values.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) samples.values.back().set(samples.measures[k], std::exp(own[k] + 0.01 * normal(random)));
      samples.labels.emplace_back(person % 2 == 0 ? "a" : "b");
      samples.subjects.push_back("S" + std::to_string(person));
    }
  }

  const Evaluation by_person = evaluated(samples);
  EXPECT_TRUE(by_person.is_label_of_person);
  EXPECT_EQ(by_person.independent, 10.0);
  EXPECT_FALSE(by_person.is_better_than_chance()) << by_person.accuracy;

  samples.subjects.assign(samples.subjects.size(), "");
  const Evaluation by_row = evaluated(samples);
  EXPECT_EQ(by_row.rows_without, 80U);
  EXPECT_EQ(by_row.subjects, 0U);
  EXPECT_TRUE(by_row.is_of_too_few());
}

SteadinessModel made_model() {
  const Samples samples = made_samples(6, 3.0, 2);
  return {.label = "eyes", .profile = "lp10", .discriminant = fit(samples, all_of(samples)).value(), .rows = 24, .subjects = 6};
}

TEST(SteadinessModel, Text_IsReadBackTheSame) {
  const SteadinessModel model = made_model();

  const auto again = read_model_text(model_text(model), "model.json");

  ASSERT_TRUE(again) << again.error().what;
  EXPECT_EQ(model_text(*again), model_text(model));
  EXPECT_EQ(again->discriminant.weights, model.discriminant.weights);
}

TEST(SteadinessModel, Damage_IsNamed) {
  const std::string text = model_text(made_model());
  const auto damaged = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    if (at != std::string::npos) changed.replace(at, from.size(), to);
    const auto read = read_model_text(changed, "model.json");
    EXPECT_FALSE(read) << from << " -> " << to;
    return read ? std::string() : read.error().what;
  };

  EXPECT_THAT(damaged("\"MVELO\"", "\"MVELOX\""), HasSubstr("unknown measure 'MVELOX'"));
  EXPECT_THAT(damaged("\"MVELO\"", "\"RDIST\""), HasSubstr("RDIST occurs twice"));
  EXPECT_THAT(damaged("\"format\": 1", "\"format\": 2"), HasSubstr("'format'"));
  EXPECT_THAT(damaged("\"sd\": ", "\"sd\": -"), HasSubstr("'sd'"));
  EXPECT_THAT(damaged("\"offsets\": [", "\"offsets\": [0.5,"), HasSubstr("'offsets'"));
  EXPECT_THAT(damaged("\"offsets\": [", "\"offsets\": [1e999,"), HasSubstr("not JSON"));
  EXPECT_THAT(damaged("\"weights\": [", "\"weights\": [[],"), HasSubstr("'weights'"));
  EXPECT_THAT(damaged("\"a\"", "\"b\""), HasSubstr("is not in alphabetical order"));
  EXPECT_THAT(damaged("\"least\"", "\"lowest\""), HasSubstr("'least' is missing"));
  for (std::size_t length = 0; length + 2 < text.size(); length += 7)
    EXPECT_FALSE(read_model_text(text.substr(0, length), "cut")) << length;
  for (const char* other : {"", "[]", "3", "null", "{}", "\xff\xfe"}) EXPECT_FALSE(read_model_text(other, "other")) << other;
}

}  // namespace
}  // namespace dts::lab::steadiness
