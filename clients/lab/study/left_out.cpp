// SPDX-License-Identifier: Apache-2.0
#include "lab/study/left_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "classifier/trunk_model_parts.h"
#include "lab/training/fits.h"
#include "lab/training/left_out_parts.h"
#include "lab/training/model_training.h"

namespace dts::lab::study {
namespace {

using classifier::kClasses;
using core::TrunkClass;
using training::ClassifiedReach;
using training::LeftOutReach;

constexpr double kIntervalPart = 0.9;
constexpr double kRejectBelow = 0.9;

double off_deg(const AngleError& error) { return std::abs(error.estimated_deg - error.true_deg); }

double rms_deg(const std::vector<AngleError>& errors) {
  double squares = 0.0;
  for (const AngleError& error : errors) squares += off_deg(error) * off_deg(error);
  return errors.empty() ? kUnknown : std::sqrt(squares / static_cast<double>(errors.size()));
}

/// Returns the half widths by the class of the estimated angle, without one volunteer.
std::array<double, kClasses> widths_without(const std::vector<AngleError>& errors, std::size_t volunteer) {
  std::array<std::vector<double>, kClasses> off;
  for (const AngleError& error : errors) {
    if (error.volunteer != volunteer) off[classifier::class_index(error.estimated_deg)].push_back(off_deg(error));
  }
  std::array<double, kClasses> widths{};
  for (std::size_t k = 0; k < kClasses; ++k) {
    widths[k] = off[k].empty() ? 0.0 : training::conformal_quantile(std::move(off[k]), kIntervalPart);
  }
  return widths;
}

std::vector<AngleError> errors_of(const std::vector<ClassifiedReach>& classified) {
  std::vector<AngleError> errors;
  for (const auto& [reach, movement, volunteer, arm_alone] : classified) {
    const bool counts = reach->wanted >= TrunkClass::Minor && std::isfinite(movement.trunk_deg);
    if (counts) errors.push_back({volunteer, movement.trunk_deg, reach->flexion_deg});
  }
  return errors;
}

LeftOutFigures figures_of(const training::TrainingSet& set, const std::vector<LeftOutReach>& left_out,
                          core::TrunkMovement LeftOutReach::*view) {
  std::vector<ClassifiedReach> classified;
  for (const LeftOutReach& one : left_out)
    classified.push_back({&set.reaches[one.reach], one.*view, set.reaches[one.reach].subject, one.arm_alone});
  const std::vector<AngleError> errors = errors_of(classified);
  LeftOutFigures figures{.answers = std::vector<Confusion>(set.subjects.size())};
  std::vector<training::Forecast> forecasts;
  for (std::size_t volunteer = 0; volunteer < set.subjects.size(); ++volunteer) {
    const double temperature = training::fit_temperature(training::forecasts_of(classified, volunteer));
    const auto widths = widths_without(errors, volunteer);
    const double none_from = training::none_from_of(classified, volunteer);
    for (const ClassifiedReach& one : classified) {
      if (one.group != volunteer) continue;
      const training::TrainingReach* const reach = one.reach;
      core::TrunkMovement movement = one.movement;
      movement.trunk_class = training::guess_of(one, none_from);
      figures.answers[volunteer].add(reach->wanted, movement.trunk_class);
      movement.probability = training::tempered(movement.probability, temperature);
      const TrunkClass answer = training::is_kept(movement, widths, kRejectBelow) ? movement.trunk_class : TrunkClass::Rejected;
      figures.kept.add(reach->wanted, answer);
      if (reach->wanted < TrunkClass::Minor) continue;
      figures.kept_by_angle.add(true_class(reach->flexion_deg), answer);
      forecasts.push_back({movement.probability, static_cast<std::size_t>(reach->wanted) - 1});
    }
  }
  figures.calibration_error = forecasts.empty() ? kUnknown : training::calibration_error(forecasts);
  figures.angle_rms_deg = rms_deg(errors);
  figures.angle_coverage = coverage_left_out(errors, set.subjects.size());
  return figures;
}

/// Counts every reach that was not found or is unfit as rejected, so that no reach is missing.
void add_unclassified(const std::vector<const StudyGroup*>& groups, LeftOutFigures& figures) {
  std::size_t first = 0;
  for (const StudyGroup* group : groups) {
    for (const StudyReach& one : group->reaches) {
      const bool is_unfit = !one.reach || !training::is_usable({.subject = first + one.volunteer,
                                                                .features = one.reach->features,
                                                                .flags = one.reach->flags,
                                                                .wanted = one.wanted,
                                                                .flexion_deg = one.flexion_deg});
      if (!is_unfit) continue;
      figures.answers[first + one.volunteer].add(one.wanted, TrunkClass::Rejected);
      figures.kept.add(one.wanted, TrunkClass::Rejected);
    }
    first += group->volunteers.size();
  }
}

using classifier::SubjectCalibration;
using classifier::TrunkModel;

/// Collects the figures.
class Tally {
 public:
  explicit Tally(std::size_t volunteers) { figures_.answers.resize(volunteers); }

  void add(const StudyReach& one, std::size_t volunteer, const TrunkModel& model, const SubjectCalibration* subject) {
    if (!one.reach) {
      figures_.answers[volunteer].add(one.wanted, TrunkClass::Rejected);
      return add_kept(one, TrunkClass::Rejected);
    }
    const core::ReachFeatures& features = one.reach->features;
    figures_.answers[volunteer].add(one.wanted, model.best_guess(features, one.reach->flags, subject).trunk_class);
    const core::TrunkMovement movement = model.classify(features, one.reach->flags, subject);
    add_kept(one, movement.trunk_class);
    if (one.wanted < TrunkClass::Minor || (movement.reasons & core::class_reason::kBadReach) != 0) return;
    forecasts_.push_back({movement.probability, static_cast<std::size_t>(one.wanted) - 1});
    if (!std::isfinite(movement.trunk_deg)) return;
    const double off_deg = movement.trunk_deg - one.flexion_deg;
    squares_ += off_deg * off_deg;
    ++angles_;
    if (one.flexion_deg >= movement.trunk_lo_deg && one.flexion_deg <= movement.trunk_hi_deg) ++covered_;
  }

  [[nodiscard]] LeftOutFigures finish() {
    if (!forecasts_.empty()) figures_.calibration_error = training::calibration_error(forecasts_);
    if (angles_ == 0) return std::move(figures_);
    figures_.angle_rms_deg = std::sqrt(squares_ / static_cast<double>(angles_));
    figures_.angle_coverage = static_cast<double>(covered_) / static_cast<double>(angles_);
    return std::move(figures_);
  }

 private:
  void add_kept(const StudyReach& one, TrunkClass answer) {
    figures_.kept.add(one.wanted, answer);
    if (one.wanted >= TrunkClass::Minor) figures_.kept_by_angle.add(true_class(one.flexion_deg), answer);
  }

  LeftOutFigures figures_;
  std::vector<training::Forecast> forecasts_;
  double squares_ = 0.0;
  std::size_t angles_ = 0;
  std::size_t covered_ = 0;
};

}  // namespace

double coverage_left_out(const std::vector<AngleError>& errors, std::size_t volunteers) {
  if (volunteers < 2 || errors.empty()) return kUnknown;
  std::size_t covered = 0;
  for (std::size_t volunteer = 0; volunteer < volunteers; ++volunteer) {
    const auto widths = widths_without(errors, volunteer);
    covered += static_cast<std::size_t>(std::ranges::count_if(errors, [&](const AngleError& error) {
      return error.volunteer == volunteer && off_deg(error) <= widths[classifier::class_index(error.estimated_deg)];
    }));
  }
  return static_cast<double>(covered) / static_cast<double>(errors.size());
}

core::Result<RecommendedResult> classify_volunteers_left_out(const std::vector<const StudyGroup*>& groups, std::uint64_t seed,
                                                             const Progress& progress) {
  const training::TrainingSet set = training_set(groups);
  DTS_TRY_ASSIGN(const auto classified, training::classify_left_out(set, {.seed = seed}, progress));
  RecommendedResult result{.general = figures_of(set, classified, &LeftOutReach::general),
                           .own = figures_of(set, classified, &LeftOutReach::own)};
  for (const training::TrainingSubject& subject : set.subjects) result.names.push_back(subject.name);
  add_unclassified(groups, result.general);
  add_unclassified(groups, result.own);
  return result;
}

RecommendedResult classify_by_model(const TrunkModel& model, const std::vector<const StudyGroup*>& groups) {
  const training::TrainingSet set = training_set(groups);
  RecommendedResult result;
  std::vector<std::optional<SubjectCalibration>> scales;
  for (std::size_t subject = 0; subject < set.subjects.size(); ++subject) {
    result.names.push_back(set.subjects[subject].name);
    const auto all = training::calibrations_of(set, subject);
    scales.push_back(all.empty() ? std::nullopt : std::optional(all.front()));
  }
  Tally general(set.subjects.size());
  Tally own(set.subjects.size());
  std::size_t first = 0;
  for (const StudyGroup* group : groups) {
    for (const StudyReach& one : group->reaches) {
      const std::size_t volunteer = first + one.volunteer;
      general.add(one, volunteer, model, nullptr);
      own.add(one, volunteer, model, scales[volunteer] ? &*scales[volunteer] : nullptr);
    }
    first += group->volunteers.size();
  }
  result.general = general.finish();
  result.own = own.finish();
  return result;
}

}  // namespace dts::lab::study
