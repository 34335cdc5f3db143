// SPDX-License-Identifier: Apache-2.0
#include "classifier/trunk_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "classifier/trunk_model_parts.h"

namespace dts::classifier {
namespace {

namespace flag = core::reach_flag;
namespace reason = core::class_reason;
using core::TrunkClass;
using core::TrunkMovement;

constexpr double kLightestPart = 0.7;              ///< Of the lowest P1 in training: a model of adults does not classify a child.
constexpr double kHeaviestPart = 1.35;             ///< Of the highest P1 in training.
constexpr double kLargestContradictionDeg = 18.0;  ///< Twice the combined error of geometry (6.7 deg rms, reach-model section 3) and a
                                                   ///< model.
/// Doubtful reaches need a higher probability, far from a border. With a substituted sensor, d2 is wrong by up to a tenth; after a pause,
/// the second movement is quicker than a reach; a rest that was not measured is a guess.
constexpr std::uint16_t kDoubtfulFlags = flag::kSubstituted | flag::kResumed | flag::kBaselineUncertain;
constexpr double kDoubtfulLimit = 0.98;

/// The result before any rejection.
struct Classification {
  TrunkMovement movement;
  TrunkClass guess = TrunkClass::Rejected;
  double probability = 0.0;  ///< Of the guess.
  bool is_known = false;
};

double sine_of(double deg) noexcept { return std::sin(deg * std::numbers::pi / 180.0); }

bool is_subject_usable(const SubjectCalibration* subject) noexcept {
  return subject != nullptr && std::isfinite(subject->max_d2_mm) && subject->max_d2_mm > 0.0 && subject->max_flexion_deg > 0.0 &&
         subject->max_flexion_deg <= 90.0;
}

/// Returns the flexion at the subject's maximum, as the average of geometry and the general model. Uses only the model if geometry needs
/// less than class 3, or if the two contradict each other: a person who bends the trunk without need (thesis 6.4.2, S1 and S5) does not
/// follow the geometry.
double maximum_deg(const TrunkModelForm& form, const SubjectCalibration& subject) noexcept {
  if (!form.angle) return subject.max_flexion_deg;
  const auto inputs = scale(form.angle->sine.inputs, subject.maximum, nullptr, true);
  if (!inputs.is_known) return subject.max_flexion_deg;
  const double seen_deg = angle_of(*form.angle, inputs, 1.0).deg;
  if (subject.max_flexion_deg < kMaximumFromDeg || std::abs(seen_deg - subject.max_flexion_deg) > kLargestContradictionDeg) return seen_deg;
  return (seen_deg + subject.max_flexion_deg) / 2.0;
}

void set_angle(TrunkMovement& movement, const Angle& angle) noexcept {
  movement.trunk_deg = angle.deg;
  movement.trunk_lo_deg = angle.lowest_deg;
  movement.trunk_hi_deg = angle.highest_deg;
}

void mark_range(TrunkMovement& movement, const ScaledInputs& inputs) noexcept {
  if (!inputs.is_in_range) movement.reasons |= reason::kOutOfRange;
}

/// Classifies by the subject's own scale; returns false if a feature for it is missing.
bool classify_by_own_scale(const TrunkModelForm& form, const core::ReachFeatures& features, const SubjectCalibration& subject,
                           TrunkMovement& movement) noexcept {
  if (!form.own || !form.own_angle) return false;
  const auto inputs = scale(form.own->inputs, features, &subject, true);
  const auto angle_inputs = scale(form.own_angle->sine.inputs, features, &subject, true);
  if (!inputs.is_known || !angle_inputs.is_known) return false;
  const double largest_deg = maximum_deg(form, subject);
  const Angle angle = angle_of(*form.own_angle, angle_inputs, sine_of(largest_deg));
  set_angle(movement, angle);
  mark_range(movement, inputs);
  movement.reasons |= reason::kCalibrated;
  // A subject whose own maximum is below class 3 has no reach of class 3: then only the angle decides.
  movement.probability = largest_deg > kMaximumFromDeg ? probabilities(*form.own, inputs) : probabilities(angle);
  return true;
}

bool classify_in_general(const TrunkModelForm& form, const core::ReachFeatures& features, TrunkMovement& movement) noexcept {
  const auto inputs = scale(form.general.inputs, features, nullptr, form.kind == ModelKind::Recommended);
  if (!inputs.is_known) return false;
  movement.probability = probabilities(form.general, inputs);
  mark_range(movement, inputs);
  if (!form.angle) return true;
  const auto angle_inputs = scale(form.angle->sine.inputs, features, nullptr, true);
  if (angle_inputs.is_known) set_angle(movement, angle_of(*form.angle, angle_inputs, 1.0));
  return true;
}

/// Returns whether the class's window of angles is outside the interval of the angle.
bool contradicts(TrunkClass guess, const TrunkMovement& movement) noexcept {
  if (!std::isfinite(movement.trunk_deg)) return false;
  const auto index = static_cast<std::size_t>(std::max(1, static_cast<int>(guess)) - 1);
  return class_index(movement.trunk_lo_deg) > index || class_index(movement.trunk_hi_deg) < index;
}

/// Returns whether the flags forbid a class. A sensor at the end of its range reads too little, so the reach is at least as large as it
/// looks: the highest class stays the highest.
bool is_unfit(TrunkClass guess, std::uint16_t flags) noexcept {
  const int unfit = flags & kUnfitFlags;
  return guess == TrunkClass::Maximum ? (unfit & ~flag::kSaturated) != 0 : unfit != 0;
}

/// Returns the probability that the class must have.
double limit_of(const TrunkModelForm& form, std::uint16_t flags) noexcept {
  // A sensor at the end of its range is substituted, which is the same doubt: it counts once, in `is_unfit`.
  const int doubts = flags & kDoubtfulFlags & ((flags & flag::kSaturated) != 0 ? ~flag::kSubstituted : ~0);
  return doubts != 0 ? std::max(form.reject_below, kDoubtfulLimit) : form.reject_below;
}

bool is_sound(const core::ReachFeatures& features) noexcept {
  return std::isfinite(features.d1_mm()) && std::isfinite(features.d2_mm()) && std::isfinite(features.p1_mm) && features.p1_mm > 0.0;
}

void guess_class(const TrunkModel& model, const core::ReachFeatures& features, std::uint16_t flags,
                 Classification& classification) noexcept {
  const auto& probability = classification.movement.probability;
  auto best = std::max_element(probability.begin(), probability.end());
  if ((flags & flag::kMinor) != 0) {
    best = probability.begin();
    classification.movement.reasons |= reason::kMinor;
  }
  classification.guess = static_cast<TrunkClass>(best - probability.begin() + 1);
  classification.probability = *best;
  if (classification.guess == TrunkClass::Minor && model.form().arm_alone &&
      model.arm_alone_probability(features) >= model.form().arm_alone->none_from) {
    classification.guess = TrunkClass::None;
  }
}

Classification classify_unrejected(const TrunkModel& model, const core::ReachFeatures& features, std::uint16_t flags,
                                   const SubjectCalibration* subject) noexcept {
  Classification classification;
  TrunkMovement& movement = classification.movement;
  movement.probability.fill(1.0 / static_cast<double>(kClasses));
  movement.reasons = reason::kBadReach;
  const TrunkModelForm& form = model.form();
  if (form.general.networks.empty() || !is_sound(features)) return classification;
  movement.reasons = 0;
  const bool is_own = is_subject_usable(subject) && classify_by_own_scale(form, features, *subject, movement);
  if (!is_own && !classify_in_general(form, features, movement)) {
    movement.reasons |= reason::kBadReach;
    return classification;
  }
  classification.is_known = true;
  // Too little deflection gives no upper limit of the angle.
  if ((flags & flag::kSaturated) != 0 && std::isfinite(movement.trunk_deg)) movement.trunk_hi_deg = kLargestFlexionDeg;
  guess_class(model, features, flags, classification);
  if (features.p1_mm < kLightestPart * form.p1_minimum_mm || features.p1_mm > kHeaviestPart * form.p1_maximum_mm) {
    movement.reasons |= reason::kOutOfRange;
  }
  if (is_unfit(classification.guess, flags)) movement.reasons |= reason::kBadReach;
  if (!(classification.probability >= limit_of(form, flags))) movement.reasons |= reason::kUnsure;
  if (contradicts(classification.guess, movement)) movement.reasons |= reason::kDisagreement;
  return classification;
}

}  // namespace

core::Result<TrunkModel> TrunkModel::create(TrunkModelForm form) {
  DTS_TRY(check(form));
  return TrunkModel(std::move(form));
}

double TrunkModel::arm_alone_probability(const core::ReachFeatures& features) const noexcept {
  if (!form_.arm_alone) return core::ReachFeatures::kUnknown;
  const auto inputs = scale(form_.arm_alone->logit.inputs, features, nullptr, true);
  return inputs.is_known ? classifier::arm_alone_probability(*form_.arm_alone, inputs) : core::ReachFeatures::kUnknown;
}

TrunkMovement TrunkModel::classify(const core::ReachFeatures& features, std::uint16_t flags,
                                   const SubjectCalibration* subject) const noexcept {
  constexpr std::uint16_t kRejecting = reason::kUnsure | reason::kOutOfRange | reason::kBadReach | reason::kDisagreement;
  const Classification classification = classify_unrejected(*this, features, flags, subject);
  TrunkMovement movement = classification.movement;
  movement.trunk_class = (movement.reasons & kRejecting) != 0 ? TrunkClass::Rejected : classification.guess;
  return movement;
}

TrunkMovement TrunkModel::best_guess(const core::ReachFeatures& features, std::uint16_t flags,
                                     const SubjectCalibration* subject) const noexcept {
  const Classification classification = classify_unrejected(*this, features, flags, subject);
  TrunkMovement movement = classification.movement;
  movement.trunk_class = classification.guess;
  return movement;
}

}  // namespace dts::classifier
