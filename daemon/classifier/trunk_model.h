// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "classifier/subject_calibration.h"
#include "classifier/trunk_model_form.h"
#include "core/reach.h"
#include "core/result.h"

namespace dts::classifier {

// Borders between the classes; equal to physics::kModerateFromDeg and kMaximumFromDeg, which this folder must not include.
inline constexpr double kModerateFromDeg = 15.25;
inline constexpr double kMaximumFromDeg = 42.2;

/// A reach with one of these flags is not classified: its levels or its end are not those of a valid reach.
inline constexpr std::uint16_t kUnfitFlags = core::reach_flag::kDipOnly | core::reach_flag::kTimeout | core::reach_flag::kSaturated |
                                             core::reach_flag::kImplausible | core::reach_flag::kStoodUp | core::reach_flag::kUntared;

/// Classifies trunk flexion from the features of a reach. Immutable. Thread: any.
class TrunkModel {
 public:
  /// A model without data; rejects every reach.
  TrunkModel() = default;
  /// Fails as `check`.
  [[nodiscard]] static core::Result<TrunkModel> create(TrunkModelForm form);

  /// Rejects doubtful reaches by their `flags`, see core::reach_flag. `subject` (may be nullptr) scales by the person's own maximum
  /// reaches. Never returns a confident wrong answer: the result is Rejected, with reasons, if the reach is outside the training range,
  /// uncertain or doubtful.
  /// Realtime-safe: yes.
  [[nodiscard]] core::TrunkMovement classify(const core::ReachFeatures& features, std::uint16_t flags,
                                             const SubjectCalibration* subject = nullptr) const noexcept;

  /// Does the same, but returns the most probable class despite all doubts; Rejected only if nothing can be computed. For studies.
  /// Realtime-safe: yes.
  [[nodiscard]] core::TrunkMovement best_guess(const core::ReachFeatures& features, std::uint16_t flags,
                                               const SubjectCalibration* subject = nullptr) const noexcept;

  /// Returns the probability that only the arm moved; NaN if the model has no rule or a feature is missing. Realtime-safe: yes.
  [[nodiscard]] double arm_alone_probability(const core::ReachFeatures& features) const noexcept;

  [[nodiscard]] const TrunkModelForm& form() const noexcept { return form_; }

 private:
  explicit TrunkModel(TrunkModelForm form) : form_(std::move(form)) {}

  TrunkModelForm form_;
};

}  // namespace dts::classifier
