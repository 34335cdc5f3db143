// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "classifier/subject_calibration.h"
#include "classifier/trunk_model_form.h"
#include "core/reach.h"
#include "core/result.h"

namespace dts::classifier {

// Borders between the classes; the same as physics::kModerateFromDeg and kMaximumFromDeg, which this room may not know.
inline constexpr double kModerateFromDeg = 15.25;
inline constexpr double kMaximumFromDeg = 42.2;

/// Flags of a reach that is not judged: its levels or its end are not those of a reach.
inline constexpr std::uint16_t kUnfitFlags = core::reach_flag::kDipOnly | core::reach_flag::kTimeout | core::reach_flag::kSaturated |
                                             core::reach_flag::kImplausible | core::reach_flag::kStoodUp | core::reach_flag::kUntared;

/// Tells the degree of trunk bending from the features of a reach. Immutable. Thread: any.
class TrunkModel {
 public:
  /// Knows nothing and rejects everything.
  TrunkModel() = default;
  /// Fails as `check` does.
  [[nodiscard]] static core::Result<TrunkModel> create(TrunkModelForm form);

  /// `flags` of the reach, see core::reach_flag: doubtful reaches are rejected. `subject` (nullptr: none) scales by the person's own
  /// maximum reaches. Never a confident wrong answer: what is outside the training range, unsure or doubtful is Rejected, with reasons.
  /// Realtime-safe: yes.
  [[nodiscard]] core::TrunkMovement classify(const core::ReachFeatures& features, std::uint16_t flags,
                                             const SubjectCalibration* subject = nullptr) const noexcept;

  /// The same, but the most probable class stands whatever speaks against it; Rejected only when nothing can be computed. For studies.
  /// Realtime-safe: yes.
  [[nodiscard]] core::TrunkMovement best_guess(const core::ReachFeatures& features, std::uint16_t flags,
                                               const SubjectCalibration* subject = nullptr) const noexcept;

  /// Probability that only the arm moved; NaN: the model has no rule, or a feature is missing. Realtime-safe: yes.
  [[nodiscard]] double arm_alone_probability(const core::ReachFeatures& features) const noexcept;

  [[nodiscard]] const TrunkModelForm& form() const noexcept { return form_; }

 private:
  explicit TrunkModel(TrunkModelForm form) : form_(std::move(form)) {}

  TrunkModelForm form_;
};

}  // namespace dts::classifier
