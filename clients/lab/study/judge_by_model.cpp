// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <optional>

#include "lab/study/left_out.h"
#include "lab/training/fits.h"

namespace dts::lab::study {
namespace {

using classifier::SubjectCalibration;
using classifier::TrunkModel;
using core::TrunkClass;

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

RecommendedResult judge_by_model(const TrunkModel& model, const std::vector<const StudyGroup*>& groups) {
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
