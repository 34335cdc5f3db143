// SPDX-License-Identifier: Apache-2.0
#include "lab/training/model_training.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "classifier/trunk_model_parts.h"

namespace dts::lab::training {
namespace {

using classifier::kClasses;
using classifier::TrunkModel;
using classifier::TrunkModelForm;
using core::TrunkClass;
using core::TrunkMovement;

constexpr std::size_t kNetworksLeftOut = 5;  ///< Of an ensemble trained to be thrown away: eleven say nearly the same.
constexpr double kIntervalPart = 0.9;
constexpr std::size_t kEnoughResiduals = 20;  ///< Fewer in a band: all bands together.
constexpr std::size_t kEnoughFolds = 8;
constexpr std::size_t kLeastPeople = 3;  ///< To leave one out.

/// A movement with the truth.
struct Judged {
  const TrainingReach* reach = nullptr;
  TrunkMovement movement;
};

std::optional<classifier::SubjectCalibration> first_calibration(const TrainingSet& set, std::size_t subject) {
  const auto calibrations = calibrations_of(set, subject);
  return calibrations.empty() ? std::nullopt : std::optional(calibrations.front());
}

void judge_fold(const TrunkModel& model, const TrainingSet& set, const std::vector<std::size_t>& fold, std::vector<LeftOutReach>& judged) {
  for (const std::size_t subject : fold) {
    const auto own = first_calibration(set, subject);
    for (std::size_t k = 0; k < set.reaches.size(); ++k) {
      const TrainingReach& reach = set.reaches[k];
      if (reach.subject != subject || !is_usable(reach)) continue;
      LeftOutReach result{.reach = k, .general = model.best_guess(reach.features, reach.flags), .own = {}};
      result.own = own ? model.best_guess(reach.features, reach.flags, &*own) : result.general;
      result.arm_alone = model.arm_alone_probability(reach.features);
      result.has_own = own && (result.own.reasons & core::class_reason::kCalibrated) != 0;
      judged.push_back(result);
    }
  }
}

/// How probable the arm alone is held to be where the trunk moved a little.
std::vector<double> arm_alone_of_minor(const TrainingSet& set, const std::vector<LeftOutReach>& judged) {
  std::vector<double> probabilities;
  for (const LeftOutReach& one : judged) {
    if (set.reaches[one.reach].wanted == TrunkClass::Minor && std::isfinite(one.arm_alone)) probabilities.push_back(one.arm_alone);
  }
  return probabilities;
}

std::vector<Forecast> forecasts_of(const std::vector<Judged>& judged) {
  std::vector<Forecast> forecasts;
  for (const auto& [reach, movement] : judged) {
    if (reach->wanted >= TrunkClass::Minor) forecasts.push_back({movement.probability, static_cast<std::size_t>(reach->wanted) - 1});
  }
  return forecasts;
}

/// Half widths by the class of the angle that was estimated, from reaches that moved the trunk.
std::array<double, kClasses> residuals_of(const std::vector<Judged>& judged) {
  std::array<std::vector<double>, kClasses> by_class;
  std::vector<double> all;
  for (const auto& [reach, movement] : judged) {
    if (reach->wanted < TrunkClass::Minor || !std::isfinite(movement.trunk_deg)) continue;
    const double residual_deg = std::abs(movement.trunk_deg - reach->flexion_deg);
    by_class[classifier::class_index(movement.trunk_deg)].push_back(residual_deg);
    all.push_back(residual_deg);
  }
  std::array<double, kClasses> residuals{};
  for (std::size_t k = 0; k < kClasses; ++k) {
    residuals[k] = std::max(0.5, conformal_quantile(by_class[k].size() < kEnoughResiduals ? all : by_class[k], kIntervalPart));
  }
  return residuals;
}

struct Views {
  std::vector<Judged> general;
  std::vector<Judged> own;
};

Views views_of(const TrainingSet& set, const std::vector<LeftOutReach>& judged, const std::set<std::size_t>& subjects) {
  Views views;
  for (const LeftOutReach& one : judged) {
    const TrainingReach& reach = set.reaches[one.reach];
    if (!subjects.empty() && subjects.count(reach.subject) == 0) continue;
    views.general.push_back({&reach, one.general});
    if (one.has_own) views.own.push_back({&reach, one.own});
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

double accuracy_of(const std::vector<Judged>& judged, double reject_below, double temperature, double& kept_part) {
  std::size_t all = 0;
  std::size_t kept = 0;
  std::size_t right = 0;
  for (const Forecast& forecast : forecasts_of(judged)) {
    auto probability = forecast.probability;
    double total = 0.0;
    for (double& value : probability) total += value = std::pow(value, 1.0 / temperature);
    const auto best = std::max_element(probability.begin(), probability.end());
    ++all;
    if (*best / total < reject_below) continue;
    ++kept;
    right += static_cast<std::size_t>(best - probability.begin()) == forecast.wanted ? 1 : 0;
  }
  kept_part = all == 0 ? 0.0 : static_cast<double>(kept) / static_cast<double>(all);
  return kept == 0 ? 0.0 : static_cast<double>(right) / static_cast<double>(kept);
}

std::vector<Forecast> tempered(std::vector<Forecast> forecasts, double temperature) {
  for (Forecast& forecast : forecasts) {
    double total = 0.0;
    for (double& value : forecast.probability) total += value = std::pow(value, 1.0 / temperature);
    for (double& value : forecast.probability) value /= total;
  }
  return forecasts;
}

void set_angle_figures(const std::vector<Judged>& judged, const std::array<double, kClasses>& residual_deg,
                       classifier::ModelFigures& figures) {
  double square = 0.0;
  std::size_t count = 0;
  std::size_t covered = 0;
  for (const auto& [reach, movement] : judged) {
    if (reach->wanted < TrunkClass::Minor || !std::isfinite(movement.trunk_deg)) continue;
    const double difference_deg = movement.trunk_deg - reach->flexion_deg;
    square += difference_deg * difference_deg;
    ++count;
    covered += std::abs(difference_deg) <= residual_deg[classifier::class_index(movement.trunk_deg)] ? 1 : 0;
  }
  if (count == 0) return;
  figures.left_out_angle_rms_deg = std::sqrt(square / static_cast<double>(count));
  figures.left_out_angle_coverage = static_cast<double>(covered) / static_cast<double>(count);
}

void set_figures(TrunkModelForm& form, const Views& views) {
  double kept = 0.0;
  form.figures.left_out_accuracy = accuracy_of(views.general, 0.0, 1.0, kept);
  form.figures.left_out_kept_accuracy = accuracy_of(views.general, form.reject_below, form.general.temperature, kept);
  form.figures.left_out_kept = kept;
  form.figures.expected_calibration_error = calibration_error(tempered(forecasts_of(views.general), form.general.temperature));
  if (!views.own.empty()) form.figures.left_out_own_accuracy = accuracy_of(views.own, 0.0, 1.0, kept);
}

/// Class 0 only from a probability that at most two in a hundred reaches of class 1 have: these must not get lost to it.
double none_from_of(const std::vector<double>& of_minor) {
  constexpr double kLostPart = 0.02;
  return std::clamp(conformal_quantile(of_minor, 1.0 - kLostPart) + 1e-6, 0.5 + 1e-6, 1.0);
}

/// What takes people left out.
void calibrate(TrunkModelForm& form, const TrainingSet& set, const std::vector<LeftOutReach>& judged) {
  const Views all = views_of(set, judged, {});
  if (form.kind == classifier::ModelKind::Recommended) {
    // Few people who are all told apart would make a model as sure as can be of everybody.
    const double coldest = folds_of(set).size() < kEnoughFolds ? 1.0 : 0.0;
    form.general.temperature = std::max(coldest, fit_temperature(forecasts_of(all.general)));
    if (form.angle) form.angle->residual_deg = residuals_of(all.general);
    if (form.arm_alone) form.arm_alone->none_from = none_from_of(arm_alone_of_minor(set, judged));
    if (form.own && !all.own.empty()) form.own->temperature = std::max(coldest, fit_temperature(forecasts_of(all.own)));
    if (form.own_angle && !all.own.empty()) form.own_angle->residual_deg = residuals_of(all.own);
  }
  const auto real = subjects_of(set, false);
  set_figures(form, real.size() < 2 ? all : views_of(set, judged, real));
  if (!form.angle) return;
  const auto simulated = subjects_of(set, true);  // whose true angles are known; geometry misses those of others by some 5 degrees
  set_angle_figures(simulated.empty() ? all.general : views_of(set, judged, simulated).general, form.angle->residual_deg, form.figures);
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

core::Result<std::vector<LeftOutReach>> judge_left_out(const TrainingSet& set, const ModelOptions& options,
                                                       const std::function<void(double)>& progress) {
  std::vector<LeftOutReach> judged;
  const auto folds = folds_of(set);
  for (std::size_t fold = 0; fold < folds.size(); ++fold) {
    if (progress) progress(static_cast<double>(fold) / static_cast<double>(folds.size()));
    const TrainingSet others = without(set, folds[fold]);
    if (others.reaches.size() == set.reaches.size()) continue;  // nothing of these subjects
    ModelOptions fewer = options;
    fewer.networks = std::min(options.networks, kNetworksLeftOut);
    auto form = fit_model(others, fewer);
    if (!form) return tl::make_unexpected(form.error());
    auto model = TrunkModel::create(std::move(*form));
    if (!model) return tl::make_unexpected(model.error());
    judge_fold(*model, set, folds[fold], judged);
  }
  return judged;
}

core::Result<TrunkModel> train_model(const TrainingSet& set, const ModelOptions& options, const std::function<void(double)>& progress) {
  auto form = fit_model(set, options);
  if (!form) return tl::make_unexpected(form.error());
  std::set<std::size_t> present;
  for (const TrainingReach& reach : set.reaches) present.insert(reach.subject);
  if (present.size() >= kLeastPeople) {
    const auto judged = judge_left_out(set, options, progress);
    if (!judged) return tl::make_unexpected(judged.error());
    calibrate(*form, set, *judged);
  }
  set_facts(*form, set, options);
  return TrunkModel::create(std::move(*form));
}

}  // namespace dts::lab::training
