// SPDX-License-Identifier: Apache-2.0
#include "lab/training/model_training.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "classifier/trunk_model_parts.h"
#include "lab/training/left_out_parts.h"

namespace dts::lab::training {
namespace {

using classifier::kClasses;
using classifier::TrunkModel;
using classifier::TrunkModelForm;
using core::TrunkClass;
using core::TrunkMovement;

constexpr std::size_t kNetworksLeftOut = 5;  ///< Per temporary ensemble: eleven networks would give almost the same answers.
constexpr std::size_t kEnoughFolds = 8;
constexpr std::size_t kLeastPeople = 3;  ///< Needed to leave one out.

std::optional<classifier::SubjectCalibration> first_calibration(const TrainingSet& set, std::size_t subject) {
  const auto calibrations = calibrations_of(set, subject);
  return calibrations.empty() ? std::nullopt : std::optional(calibrations.front());
}

void classify_fold(const TrunkModel& model, const TrainingSet& set, const std::vector<std::size_t>& fold,
                   std::vector<LeftOutReach>& classified) {
  for (const std::size_t subject : fold) {
    const auto own = first_calibration(set, subject);
    for (std::size_t k = 0; k < set.reaches.size(); ++k) {
      const TrainingReach& reach = set.reaches[k];
      if (reach.subject != subject || !is_usable(reach)) continue;
      LeftOutReach result{.reach = k, .general = model.best_guess(reach.features, reach.flags), .own = {}};
      result.own = own ? model.best_guess(reach.features, reach.flags, &*own) : result.general;
      result.arm_alone = model.arm_alone_probability(reach.features);
      result.has_own = own && (result.own.reasons & core::class_reason::kCalibrated) != 0;
      classified.push_back(result);
    }
  }
}

struct Views {
  std::vector<ClassifiedReach> general;
  std::vector<ClassifiedReach> own;
};

Views views_of(const TrainingSet& set, const std::vector<LeftOutReach>& classified) {
  std::vector<std::size_t> group_of(set.subjects.size());
  const auto folds = folds_of(set);
  for (std::size_t fold = 0; fold < folds.size(); ++fold) {
    for (const std::size_t subject : folds[fold]) group_of[subject] = fold;
  }
  Views views;
  for (const LeftOutReach& one : classified) {
    const TrainingReach& reach = set.reaches[one.reach];
    const std::size_t group = group_of[reach.subject];
    views.general.push_back({&reach, one.general, group, one.arm_alone});
    if (one.has_own) views.own.push_back({&reach, one.own, group, one.arm_alone});
  }
  return views;
}

std::set<std::size_t> subjects_of(const TrainingSet& set, bool is_simulated) {
  std::set<std::size_t> subjects;
  for (const TrainingReach& reach : set.reaches) {
    if (set.subjects[reach.subject].is_simulated == is_simulated) subjects.insert(reach.subject);
  }
  return subjects;
}

/// Applies temperature and intervals fitted to all other groups to each group's reaches.
class LeftOutTally {
 public:
  LeftOutTally(std::span<const ClassifiedReach> classified, double coldest, double reject_below)
      : classified_(classified), coldest_(coldest), reject_below_(reject_below) {
    std::set<std::size_t> groups;
    for (const ClassifiedReach& one : classified) groups.insert(one.group);
    for (const std::size_t group : groups) {
      temperatures_[group] = std::max(coldest_, fit_temperature(forecasts_of(classified, group)));
      half_widths_deg_[group] = residuals_of(classified, group);
      none_from_[group] = none_from_of(classified, group);
    }
  }

  /// Sets the figures of the reaches of `subjects`; empty: of all.
  void set_classes(const std::set<std::size_t>& subjects, classifier::ModelFigures& figures) const {
    std::vector<Forecast> forecasts;
    double right = 0.0;
    double kept = 0.0;
    double kept_right = 0.0;
    for (const ClassifiedReach& one : classified_) {
      if (!counts(one, subjects)) continue;
      TrunkMovement movement = one.movement;
      movement.probability = tempered(movement.probability, temperatures_.at(one.group));
      const auto wanted = static_cast<std::size_t>(one.reach->wanted) - 1;
      const auto best = std::ranges::max_element(movement.probability) - movement.probability.begin();
      const double is_right = static_cast<std::size_t>(best) == wanted ? 1.0 : 0.0;
      forecasts.push_back({movement.probability, wanted});
      right += is_right;
      if (!is_kept(movement, half_widths_deg_.at(one.group), reject_below_)) continue;
      kept += 1.0;
      kept_right += guess_of(one, none_from_.at(one.group)) == one.reach->wanted ? 1.0 : 0.0;
    }
    if (forecasts.empty()) return;
    figures.left_out_accuracy = right / static_cast<double>(forecasts.size());
    figures.left_out_kept = kept / static_cast<double>(forecasts.size());
    figures.left_out_kept_accuracy = kept > 0.0 ? kept_right / kept : 0.0;
    figures.expected_calibration_error = calibration_error(forecasts);
  }

  void set_angles(const std::set<std::size_t>& subjects, classifier::ModelFigures& figures) const {
    double square = 0.0;
    double count = 0.0;
    double covered = 0.0;
    for (const ClassifiedReach& one : classified_) {
      if (!counts(one, subjects) || !std::isfinite(one.movement.trunk_deg)) continue;
      const double off_deg = std::abs(one.movement.trunk_deg - one.reach->flexion_deg);
      square += off_deg * off_deg;
      count += 1.0;
      covered += off_deg <= half_widths_deg_.at(one.group)[classifier::class_index(one.movement.trunk_deg)] ? 1.0 : 0.0;
    }
    if (count == 0.0) return;
    figures.left_out_angle_rms_deg = std::sqrt(square / count);
    figures.left_out_angle_coverage = covered / count;
  }

 private:
  static bool counts(const ClassifiedReach& one, const std::set<std::size_t>& subjects) {
    return one.reach->wanted >= TrunkClass::Minor && (subjects.empty() || subjects.count(one.reach->subject) > 0);
  }

  std::span<const ClassifiedReach> classified_;
  double coldest_;
  double reject_below_;
  std::map<std::size_t, double> temperatures_;
  std::map<std::size_t, double> none_from_;
  std::map<std::size_t, std::array<double, kClasses>> half_widths_deg_;
};

/// Sets the values that need left-out people.
void calibrate(TrunkModelForm& form, const TrainingSet& set, const std::vector<LeftOutReach>& classified) {
  const Views views = views_of(set, classified);
  const bool is_recommended = form.kind == classifier::ModelKind::Recommended;
  // With few people who are all separated, the fit would make a model as confident as possible about everybody.
  const double coldest = folds_of(set).size() < kEnoughFolds ? 1.0 : 0.0;
  if (is_recommended) {
    form.general.temperature = std::max(coldest, fit_temperature(forecasts_of(views.general)));
    if (form.angle) form.angle->residual_deg = residuals_of(views.general);
    if (form.arm_alone) form.arm_alone->none_from = none_from_of(views.general);
    if (form.own && !views.own.empty()) form.own->temperature = std::max(coldest, fit_temperature(forecasts_of(views.own)));
    if (form.own_angle && !views.own.empty()) form.own_angle->residual_deg = residuals_of(views.own);
  }
  auto recorded = subjects_of(set, false);
  if (recorded.size() < 2) recorded.clear();
  const LeftOutTally tally(views.general, coldest, form.reject_below);
  tally.set_classes(recorded, form.figures);
  // True angles of simulated people are known; for other people, geometry is wrong by about 5 degrees.
  if (form.angle) tally.set_angles(subjects_of(set, true), form.figures);
  if (views.own.empty()) return;
  classifier::ModelFigures own;
  LeftOutTally(views.own, coldest, form.reject_below).set_classes(recorded, own);
  form.figures.left_out_own_accuracy = own.left_out_accuracy;
}

void set_facts(TrunkModelForm& form, const TrainingSet& set, const ModelOptions& options) {
  form.facts.data_sha256 = sha256_of(set);
  std::set<std::size_t> present;
  for (const TrainingReach& reach : set.reaches) present.insert(reach.subject);
  for (const std::size_t subject : present) {
    if (set.subjects[subject].is_simulated) {
      ++form.facts.simulated_subjects;
    } else {
      form.facts.subjects.push_back(set.subjects[subject].name);
    }
  }
  form.facts.trials = static_cast<std::uint32_t>(set.reaches.size());
  form.facts.seed = options.seed;
  form.facts.software = "dtslab " DTS_VERSION;
}

}  // namespace

core::Result<std::vector<LeftOutReach>> classify_left_out(const TrainingSet& set, const ModelOptions& options,
                                                          const std::function<void(double)>& progress) {
  std::vector<LeftOutReach> classified;
  const auto folds = folds_of(set);
  for (std::size_t fold = 0; fold < folds.size(); ++fold) {
    if (progress) progress(static_cast<double>(fold) / static_cast<double>(folds.size()));
    const TrainingSet others = without(set, folds[fold]);
    if (others.reaches.size() == set.reaches.size()) continue;  // the set has no reaches of these subjects
    ModelOptions fewer = options;
    fewer.networks = std::min(options.networks, kNetworksLeftOut);
    DTS_TRY_ASSIGN(auto form, fit_model(others, fewer));
    DTS_TRY_ASSIGN(auto model, TrunkModel::create(std::move(form)));
    classify_fold(model, set, folds[fold], classified);
  }
  return classified;
}

core::Result<TrunkModel> train_model(const TrainingSet& set, const ModelOptions& options, const std::function<void(double)>& progress) {
  DTS_TRY_ASSIGN(auto form, fit_model(set, options));
  std::set<std::size_t> present;
  for (const TrainingReach& reach : set.reaches) present.insert(reach.subject);
  if (present.size() >= kLeastPeople) {
    DTS_TRY_ASSIGN(const auto classified, classify_left_out(set, options, progress));
    calibrate(form, set, classified);
  }
  set_facts(form, set, options);
  return TrunkModel::create(std::move(form));
}

}  // namespace dts::lab::training
