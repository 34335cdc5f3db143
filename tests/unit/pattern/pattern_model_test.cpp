// SPDX-License-Identifier: Apache-2.0
#include "pattern/pattern_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "pattern/decision.h"

namespace dts::pattern {
namespace {

using posturography::Measure;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A model by hand: MVELO (as logarithm) and ELL_ANGLE tell "old" from "young".
PatternModel made_model() {
  PatternModel model{
      .label = "group",
      .condition = "condition=ec_firm",
      .about = "124 people of one city",
      .profile = "lp10",
      .rate_hz = 100.0,
      .duration_s = 60.0,
      .noise_mm = 0.05,
      .discriminant = {.classes = {"old", "young"},
                       .predictors = {{Measure::Mvelo, true, 2.0, 0.25, 3.0, 20.0}, {Measure::EllAngle, false, 5.0, 30.0, -80.0, 85.0}},
                       .weights = {{1.0 / 3.0, 0.1}, {-0.7, 0.0}},
                       .offsets = {-0.5, 0.25},
                       .shrinkage = 0.125},
      .rows = 40,
      .people = 20,
      .groups = {{.people = 9, .trials = 18, .moved = 2}, {.people = 11, .trials = 22, .moved = 0}},
      .verdict = Verdict::Told,
      .told_by = {},
      .figures = {}};
  model.figures = {.scheme = "leave one out",
                   .auc = {.value = 0.8, .low = 0.7, .high = 0.9},
                   .auc_trials = 0.77,
                   .equal_error_correct = 0.71,
                   .brier = 0.19,
                   .brier_base = 0.25,
                   .slope = 0.8,
                   .accuracy = 0.7,
                   .balanced_accuracy = 0.71,
                   .commonest_share = 0.55,
                   .permutation_p = 0.002,
                   .best_measure = "MVELO",
                   .best_auc = {.value = 0.75, .low = 0.65, .high = 0.85},
                   .gain = {.value = 0.05, .low = -0.02, .high = 0.1},
                   .rival = "age with sex",
                   .rival_auc = {.value = 0.82, .low = 0.75, .high = 0.9},
                   .rival_gain = {.value = -0.02, .low = -0.1, .high = 0.08}};
  return model;
}

posturography::Measures made_measures(double mvelo, double angle) {
  posturography::Measures measures;
  measures.set(Measure::Mvelo, mvelo);
  measures.set(Measure::EllAngle, angle);
  return measures;
}

TEST(PatternModel, Text_IsReadBackTheSame) {
  const PatternModel model = made_model();

  const auto again = read_model_text(model_text(model), "model.json");

  ASSERT_TRUE(again) << again.error().what;
  EXPECT_EQ(model_text(*again), model_text(model));
  EXPECT_EQ(again->discriminant.weights, model.discriminant.weights) << "1/3 must be the same double";
  EXPECT_EQ(again->figures.auc.low, 0.7);
  EXPECT_EQ(again->groups.at(0).moved, 2U);
  EXPECT_EQ(again->verdict, Verdict::Told);
  EXPECT_EQ(again->duration_s, 60.0);
}

TEST(PatternModel, WhatIsNotDefined_IsAbsent) {
  PatternModel model = made_model();
  model.figures.slope.reset();
  model.figures.rival.clear();

  const auto again = read_model_text(model_text(model), "model.json");

  ASSERT_TRUE(again) << again.error().what;
  EXPECT_FALSE(again->figures.slope);
  EXPECT_THAT(again->figures.rival, IsEmpty());
}

TEST(PatternModel, Damage_IsNamed) {
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

  EXPECT_THAT(damaged("\"symbol\": \"MVELO\"", "\"symbol\": \"MVELOX\""), HasSubstr("unknown measure 'MVELOX'"));
  EXPECT_THAT(damaged("\"symbol\": \"MVELO\"", "\"symbol\": \"ELL_ANGLE\""), HasSubstr("ELL_ANGLE occurs twice"));
  EXPECT_THAT(damaged("\"best_measure\": \"MVELO\"", "\"best_measure\": \"SPEED\""), HasSubstr("'best_measure'"));
  EXPECT_THAT(damaged("\"format\": 2", "\"format\": 1"), HasSubstr("'format'"));
  EXPECT_THAT(damaged("\"verdict\": \"told\"", "\"verdict\": \"certain\""), HasSubstr("'verdict'"));
  EXPECT_THAT(damaged("\"auc_people\": [", "\"auc_people\": [0.1,"), HasSubstr("'auc_people'"));
  EXPECT_THAT(damaged("\"people\": 20", "\"people\": 20.5"), HasSubstr("'people'"));
  EXPECT_THAT(damaged("\"people\": 20", "\"people\": -1"), HasSubstr("'people'"));
  EXPECT_THAT(damaged("\"groups\": [", "\"groups\": [{},"), HasSubstr("'groups'"));
  EXPECT_THAT(damaged("\"sd\": ", "\"sd\": -"), HasSubstr("'sd'"));
  EXPECT_THAT(damaged("\"offsets\": [", "\"offsets\": [0.5,"), HasSubstr("'offsets'"));
  EXPECT_THAT(damaged("\"offsets\": [", "\"offsets\": [1e999,"), HasSubstr("not JSON"));
  EXPECT_THAT(damaged("\"weights\": [", "\"weights\": [[],"), HasSubstr("'weights'"));
  EXPECT_THAT(damaged("0.3333333333333333,", ""), HasSubstr("'weights' and 'measures' have different lengths"));
  EXPECT_THAT(damaged("\"old\"", "\"z\""), HasSubstr("is not in alphabetical order"));
  EXPECT_THAT(damaged("\"least\"", "\"lowest\""), HasSubstr("'least' is missing"));
  EXPECT_THAT(damaged("\"least\": -80.0", "\"least\": 90.0"), HasSubstr("'most'"));
  for (std::size_t length = 0; length + 2 < text.size(); length += 7)
    EXPECT_FALSE(read_model_text(text.substr(0, length), "cut")) << length;
  for (const char* other : {"", "[]", "3", "null", "{}", "\xff\xfe", "\"kind\""}) EXPECT_FALSE(read_model_text(other, "other")) << other;
  EXPECT_FALSE(read_model_text(std::string(200'000, '['), "deep"));
  EXPECT_THAT(read_model_text(text + std::string(kLongestModelText, ' '), "long").error().what, HasSubstr("larger than 256 KiB"));
}

TEST(PatternModel, EveryNumber_HasItsLimits) {
  using Json = nlohmann::json;
  const Json whole = Json::parse(model_text(made_model()));
  const auto answer = [&whole](const std::string& at, double value) {
    Json changed = whole;
    changed[Json::json_pointer(at)] = value;
    const auto read = read_model_text(changed.dump(), "model.json");
    return read ? std::string("accepted") : read.error().what;
  };
  const auto name_of = [](const std::string& at) {  // an item of a list has the name of the list
    const std::string list = at.substr(0, at.find_last_not_of("/0123456789") + 1);
    return "'" + list.substr(list.rfind('/') + 1) + "'";
  };
  struct Limits {
    const char* at;
    double least, most;
  };
  for (const auto& [at, least, most] : {Limits{"/rate_hz", 0.0, 1e9},
                                        {"/duration_s", 0.0, 1e6},
                                        {"/noise_mm", 0.0, 1e3},
                                        {"/rows", 0.0, 1e9},
                                        {"/people", 0.0, 1e9},
                                        {"/shrinkage", 0.0, 1.0},
                                        {"/groups/1/people", 0.0, 1e9},
                                        {"/groups/1/trials", 0.0, 1e9},
                                        {"/groups/1/moved", 0.0, 1e9},
                                        {"/measures/0/mean", -1e12, 1e12},
                                        {"/measures/0/sd", 1e-15, 1e12},
                                        {"/measures/0/least", 1e-300, 20.0},
                                        {"/measures/0/most", 3.0, 1e12},
                                        {"/measures/1/least", -1e12, 85.0},
                                        {"/weights/0/1", -1e12, 1e12},
                                        {"/offsets/1", -1e12, 1e12},
                                        {"/figures/auc_people/0", 0.0, 1.0},
                                        {"/figures/auc_people/1", 0.0, 1.0},
                                        {"/figures/auc_people/2", 0.0, 1.0},
                                        {"/figures/auc_trials", 0.0, 1.0},
                                        {"/figures/equal_error_correct", 0.0, 1.0},
                                        {"/figures/brier", 0.0, 1.0},
                                        {"/figures/brier_base", 0.0, 1.0},
                                        {"/figures/slope", -1e6, 1e6},
                                        {"/figures/accuracy", 0.0, 1.0},
                                        {"/figures/balanced_accuracy", 0.0, 1.0},
                                        {"/figures/commonest_share", 0.0, 1.0},
                                        {"/figures/permutation_p", 0.0, 1.0},
                                        {"/figures/best_measure_auc_people/0", 0.0, 1.0},
                                        {"/figures/gain/0", -1.0, 1.0},
                                        {"/figures/rival_auc_people/0", 0.0, 1.0},
                                        {"/figures/rival_gain/2", -1.0, 1.0}}) {
    SCOPED_TRACE(at);
    EXPECT_EQ(answer(at, least), "accepted");
    EXPECT_EQ(answer(at, most), "accepted");
    EXPECT_THAT(answer(at, std::nextafter(least, -1e300)), HasSubstr(name_of(at)));
    const bool is_least = std::string_view(at).ends_with("/least");  // above the other limit, that one is named
    EXPECT_THAT(answer(at, std::nextafter(most, 1e300)), HasSubstr(is_least ? "'most'" : name_of(at)));
  }
}

TEST(PatternModel, MostClasses_AreAHundred) {
  using Json = nlohmann::json;
  const auto of_classes = [whole = Json::parse(model_text(made_model()))](std::size_t count) {
    Json changed = whole;
    for (const char* list : {"classes", "groups", "weights", "offsets"}) {
      const Json first = whole[list][0];
      changed[list] = Json::array();
      for (std::size_t k = 0; k < count; ++k) changed[list].push_back(first.is_string() ? Json(std::to_string(1000 + k)) : first);
    }
    return read_model_text(changed.dump(), "model.json");
  };
  EXPECT_TRUE(of_classes(100));
  EXPECT_THAT(of_classes(101).error().what, HasSubstr("'classes' is not a list of 2 to 100"));
  EXPECT_FALSE(of_classes(1));
}

/// Replaces every value of the model, one by one, by values that do not belong there: nothing of it may reach a decision that is not
/// finite.
TEST(PatternModel, EveryValueReplaced_IsRefusedOrGivesAFiniteDecision) {
  using Json = nlohmann::json;
  const Json whole = Json::parse(model_text(made_model()));
  const Json flat = whole.flatten();
  std::size_t tried = 0;
  for (const auto& item : flat.items()) {
    for (const Json& wrong : {Json(nullptr), Json(true), Json(-1), Json(1e300), Json(-1e300), Json("x"), Json(std::string(5000, 'x')),
                              Json::array(), Json::object(), Json::array({1, 2, 3}), Json(18446744073709551615ULL)}) {
      Json changed = whole;
      changed[Json::json_pointer(item.key())] = wrong;
      ++tried;
      const auto read = read_model_text(changed.dump(), "hostile");
      if (!read) continue;
      const Decision decision = decide(*read, {.measures = made_measures(8.0, 10.0), .profile = "lp10", .rate_hz = 100.0});
      for (const double probability : decision.answer.probabilities) EXPECT_TRUE(std::isfinite(probability)) << item.key() << wrong;
      EXPECT_EQ(read->groups.size(), read->discriminant.classes.size()) << item.key();
    }
  }
  EXPECT_GT(tried, 500U);
}

/// Bytes changed at random: nothing may crash, whatever the reader says.
TEST(PatternModel, BytesChangedAtRandom_AreReadSafely) {
  const std::string text = model_text(made_model());
  std::mt19937 random(29);
  for (int round = 0; round < 3000; ++round) {
    std::string changed = text;
    for (int k = 0; k < 1 + round % 4; ++k) changed[random() % changed.size()] = static_cast<char>(random() % 256);
    const auto read = read_model_text(changed, "random");
    if (read) (void)decide(*read, {.measures = made_measures(8.0, 10.0)});
  }
}

TEST(Decision, WithinTheTraining_IsDecided) {
  const PatternModel model = made_model();

  const Decision decision = decide(model, {.measures = made_measures(std::exp(2.25), 35.0), .profile = "lp10", .rate_hz = 100.0});

  EXPECT_EQ(decision.outcome, Outcome::Decided);
  // z = (1, 1): scores -0.5 + 1/3 + 0.1 and 0.25 - 0.7.
  const double odds = std::exp((-0.5 + 1.0 / 3.0 + 0.1) - (0.25 - 0.7));
  ASSERT_EQ(decision.answer.probabilities.size(), 2U);
  EXPECT_NEAR(decision.answer.probabilities[0], odds / (1.0 + odds), 1e-12);
  EXPECT_EQ(decision.answer.best, 0U);
}

TEST(Decision, OutsideTheTraining_NamesTheMeasure) {
  RecordProperty("requirement", "SWAY-11");
  const Decision decision = decide(made_model(), {.measures = made_measures(20.5, 0.0), .profile = "lp10", .rate_hz = 100.0});

  EXPECT_EQ(decision.outcome, Outcome::Outside);
  EXPECT_THAT(decision.answer.outside, ElementsAre(Measure::Mvelo));
  EXPECT_EQ(decision.answer.probabilities.size(), 2U) << "for comparison, though it is a guess";
  for (const double limit : {3.0, 20.0}) {
    EXPECT_EQ(decide(made_model(), {.measures = made_measures(limit, 0.0), .profile = "lp10", .rate_hz = 100.0}).outcome, Outcome::Decided);
  }
}

TEST(Decision, MovedFeet_AreNotValid) {
  RecordProperty("requirement", "SWAY-11");
  const auto measures = made_measures(20.5, 0.0);
  const Trial trial{.measures = measures, .profile = "lp10", .rate_hz = 100.0, .is_valid = false};

  EXPECT_EQ(decide(made_model(), trial).outcome, Outcome::NotValid) << "before outside";
}

TEST(Decision, MissingMeasure_IsNamed) {
  posturography::Measures measures;
  measures.set(Measure::Mvelo, 0.0);  // has no logarithm

  const Decision decision = decide(made_model(), {.measures = measures, .profile = "lp10", .rate_hz = 100.0});

  EXPECT_EQ(decision.outcome, Outcome::Missing);
  EXPECT_THAT(decision.answer.missing, ElementsAre(Measure::Mvelo, Measure::EllAngle));
  EXPECT_FALSE(decision.answer.best);
  EXPECT_THAT(decision.answer.probabilities, IsEmpty());
}

TEST(Decision, OtherProfileRateOrDuration_IsNotComparable) {
  const auto measures = made_measures(8.0, 0.0);
  EXPECT_EQ(decide(made_model(), {.measures = measures, .profile = "asis", .rate_hz = 100.0}).outcome, Outcome::NotComparable);
  EXPECT_EQ(decide(made_model(), {.measures = measures, .profile = "lp10", .rate_hz = 130.0}).outcome, Outcome::NotComparable);
  EXPECT_EQ(decide(made_model(), {.measures = measures, .profile = "lp10", .rate_hz = 100.5}).outcome, Outcome::Decided);
  const auto of_duration = [&](double duration_s) {
    return decide(made_model(), {.measures = measures, .profile = "lp10", .rate_hz = 100.0, .duration_s = duration_s}).outcome;
  };
  EXPECT_EQ(of_duration(20.0), Outcome::NotComparable) << "sway depends on the duration";
  EXPECT_EQ(of_duration(61.0), Outcome::NotComparable);
  EXPECT_EQ(of_duration(59.9), Outcome::Decided);
  EXPECT_EQ(of_duration(std::nan("")), Outcome::Decided) << "a table without the column";
  EXPECT_EQ(decide(made_model(), {.measures = measures}).outcome, Outcome::Decided) << "unknown is not another one";
}

TEST(Decision, LabelThatIsNotTold_IsNotForARig) {
  PatternModel model = made_model();
  EXPECT_TRUE(check_for_rig(model));
  model.verdict = Verdict::NotTold;
  EXPECT_THAT(check_for_rig(model).error().what, HasSubstr("'group' must not be shown: not told"));
  model.verdict = Verdict::ToldByOther;
  model.told_by = "age";
  EXPECT_THAT(check_for_rig(model).error().what, HasSubstr("told by age, not by sway"));
}

TEST(Decision, ModelOfUnknownTrials_IsNotForARig) {
  for (const auto& forget : {+[](PatternModel& model) { model.profile.clear(); }, +[](PatternModel& model) { model.rate_hz = 0.0; },
                             +[](PatternModel& model) { model.duration_s = 0.0; }}) {
    PatternModel model = made_model();
    forget(model);
    const auto checked = check_for_rig(model);
    ASSERT_FALSE(checked);
    EXPECT_THAT(checked.error().what, HasSubstr("the profile, rate or duration of its training trials is unknown or mixed"));
  }
}

TEST(Probabilities, OfScores_DoNotOverflow) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_THAT(probabilities_of({1000.0, 1000.0}), ElementsAre(0.5, 0.5));
  EXPECT_THAT(probabilities_of({-kInfinity, 3.0}), ElementsAre(0.0, 1.0));
  EXPECT_THAT(probabilities_of({-kInfinity, -kInfinity}), IsEmpty());
  EXPECT_THAT(probabilities_of({kInfinity, 0.0}), IsEmpty());
  EXPECT_THAT(probabilities_of({std::nan(""), 0.0}), IsEmpty());
  EXPECT_THAT(probabilities_of({}), IsEmpty());
}

}  // namespace
}  // namespace dts::pattern
