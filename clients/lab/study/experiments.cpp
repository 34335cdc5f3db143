// SPDX-License-Identifier: Apache-2.0
#include "lab/study/experiments.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "classifier/trunk_model.h"
#include "classifier/trunk_model_parts.h"
#include "lab/study/left_out.h"
#include "lab/training/model_fit.h"
#include "lab/training/model_training.h"
#include "lab/training/simulated_people.h"

namespace dts::lab::study {
namespace {

using core::TrunkClass;

constexpr double kLessonsPart = 0.2;  // fraction of the study's time, if it includes a model of invented people

/// Computes the correlation coefficient of pairs.
class Correlation {
 public:
  void add(double x, double y) noexcept {
    ++count_;
    const double off_x = x - mean_x_;
    const double off_y = y - mean_y_;
    mean_x_ += off_x / static_cast<double>(count_);
    mean_y_ += off_y / static_cast<double>(count_);
    xx_ += off_x * (x - mean_x_);
    yy_ += off_y * (y - mean_y_);
    xy_ += off_x * (y - mean_y_);
  }
  [[nodiscard]] double value() const noexcept { return xx_ > 0.0 && yy_ > 0.0 ? xy_ / std::sqrt(xx_ * yy_) : kUnknown; }

 private:
  std::size_t count_ = 0;
  double mean_x_ = 0.0;
  double mean_y_ = 0.0;
  double xx_ = 0.0;
  double yy_ = 0.0;
  double xy_ = 0.0;
};

/// Returns the correlation of outputs and targets, all three outputs of all reaches (thesis Fig. 5.8).
double regression_r(const classifier::TrunkModel& model, const training::TrainingSet& set) {
  const classifier::Ensemble& ensemble = model.form().general;
  Correlation correlation;
  for (const training::TrainingReach& reach : set.reaches) {
    if (!training::is_usable(reach) || reach.wanted < TrunkClass::Minor) continue;
    const auto scaled = classifier::scale(ensemble.inputs, reach.features, nullptr, false);
    if (!scaled.is_known) continue;
    const auto outputs = ensemble.networks.front().outputs(std::span(scaled.values).first(ensemble.inputs.size()));
    for (std::size_t k = 0; k < outputs.size(); ++k) {
      correlation.add(static_cast<std::size_t>(reach.wanted) == k + 1 ? 1.0 : 0.0, outputs[k]);
    }
  }
  return correlation.value();
}

std::size_t of_trunk(const training::TrainingSet& set) {
  return static_cast<std::size_t>(std::ranges::count_if(
      set.reaches, [](const auto& reach) { return training::is_usable(reach) && reach.wanted >= TrunkClass::Minor; }));
}

/// Counts a reach that was not found as rejected. The thesis has no such reaches, because its points were checked by eye (5.3.3).
std::vector<Confusion> classify(const classifier::TrunkModel& model, const StudyGroup& group) {
  std::vector<Confusion> answers(group.volunteers.size());
  for (const StudyReach& one : group.reaches) {
    if (one.wanted == TrunkClass::None) continue;
    const auto answer = one.reach ? model.best_guess(one.reach->features, one.reach->flags).trunk_class : TrunkClass::Rejected;
    answers[one.volunteer].add(one.wanted, answer);
  }
  return answers;
}

struct People {
  StudyGroup teachers;
  StudyGroup healthy;
  StudyGroup stroke;
};

core::Result<NetworkResult> teach(const StudyGroup& lessons, const People& people, std::uint64_t seed) {
  const training::TrainingSet set = training_set({&lessons});
  DTS_TRY_ASSIGN(auto form, training::fit_model(set, {.kind = classifier::ModelKind::Raw5, .networks = 1, .seed = seed}));
  DTS_TRY_ASSIGN(const auto model, classifier::TrunkModel::create(std::move(form)));
  return NetworkResult{.trained_on = of_trunk(set),
                       .own_r = regression_r(model, set),
                       .teachers = classify(model, people.teachers),
                       .healthy = classify(model, people.healthy),
                       .stroke = classify(model, people.stroke)};
}

core::Result<People> draw_people(const StudyOptions& options, std::uint64_t seed, const Progress& progress) {
  const Targets targets = options.has_recommended ? Targets::All : Targets::BeyondReach;
  People people;
  DTS_TRY_ASSIGN(people.teachers, natural_reaches(teachers(), targets, seed, [&](double done) { progress(0.15 * done); }));
  if (options.has_healthy) {
    DTS_TRY_ASSIGN(people.healthy, natural_reaches(healthy(), targets, seed, [&](double done) { progress(0.15 + 0.7 * done); }));
  }
  if (options.has_stroke) {
    DTS_TRY_ASSIGN(people.stroke, boundary_reaches(stroke(), seed, [&](double done) { progress(0.85 + 0.15 * done); }));
  }
  return people;
}

struct Lessons {
  StudyGroup one_pace;
  StudyGroup four_paces;
  std::optional<classifier::TrunkModel> invented;
};

/// Trains a model as dtsd's own model is trained, so that these figures describe the model that dtsd ships.
core::Result<classifier::TrunkModel> model_of_invented_people(const Progress& progress) {
  DTS_TRY_ASSIGN(const auto set,
                 training::simulated_people(kInventedPeople, kInventedTrials, 1, [&](double done) { progress(0.5 * done); }));
  return training::train_model(set, {.seed = 1}, [&](double done) { progress(0.5 + 0.5 * done); });
}

core::Result<Lessons> make_lessons(const StudyOptions& options, const Progress& progress) {
  DTS_TRY_ASSIGN(auto one_pace, ideal_reaches(teachers(), kThesisPaces, kIdealRepetitions));
  DTS_TRY_ASSIGN(auto four_paces, ideal_reaches(teachers(), kPaces, kIdealRepetitions));
  Lessons lessons{.one_pace = std::move(one_pace), .four_paces = std::move(four_paces), .invented = {}};
  if (!options.has_recommended) return lessons;
  DTS_TRY_ASSIGN(lessons.invented, model_of_invented_people(progress));
  return lessons;
}

core::Result<Draw> run_draw(const Lessons& lessons, const StudyOptions& options, std::uint64_t seed, const Progress& progress) {
  DTS_TRY_ASSIGN(const auto people, draw_people(options, seed, [&](double done) { progress(0.5 * done); }));
  Draw draw{.seed = seed};
  for (const auto& [lesson, result] : {std::pair(&people.teachers, &draw.nn1), std::pair(&lessons.one_pace, &draw.nn2_one_pace),
                                       std::pair(&lessons.four_paces, &draw.nn2)}) {
    DTS_TRY_ASSIGN(*result, teach(*lesson, people, seed));
  }
  if (!options.has_recommended || !options.has_healthy) return draw;
  DTS_TRY_ASSIGN(draw.recommended,
                 classify_volunteers_left_out({&people.teachers, &people.healthy}, seed, [&](double done) { progress(0.5 + 0.5 * done); }));
  draw.invented = classify_by_model(*lessons.invented, {&people.teachers, &people.healthy});
  return draw;
}

}  // namespace

core::Result<std::vector<Draw>> run_study(const StudyOptions& options, const Progress& progress) {
  const double lessons_part = options.has_recommended ? kLessonsPart : 0.0;
  DTS_TRY_ASSIGN(const auto lessons, make_lessons(options, [&](double done) { progress(lessons_part * done); }));
  std::vector<Draw> draws;
  for (std::size_t k = 0; k < options.draws; ++k) {
    const auto part = [&](double done) {
      progress(lessons_part + (1.0 - lessons_part) * (static_cast<double>(k) + done) / static_cast<double>(options.draws));
    };
    DTS_TRY_ASSIGN(auto draw, run_draw(lessons, options, options.seed + k, part));
    draws.push_back(std::move(draw));
  }
  return draws;
}

Confusion sum(const std::vector<Confusion>& all) {
  Confusion total;
  for (const Confusion& one : all) total.add(one);
  return total;
}

const Draw& middle_draw(const std::vector<Draw>& draws) {
  const auto right = [](const Draw* draw) {
    std::size_t correct = 0;
    for (const NetworkResult* network : {&draw->nn1, &draw->nn2}) {
      correct += sum(network->teachers).correct() + sum(network->healthy).correct() + sum(network->stroke).correct();
    }
    return correct;
  };
  std::vector<const Draw*> order;
  for (const Draw& draw : draws) order.push_back(&draw);
  std::ranges::stable_sort(order, {}, right);
  return *order[order.size() / 2];
}

}  // namespace dts::lab::study
