// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "classifier/subject_calibration.h"
#include "core/reach.h"

namespace dts::classifier {

/// Possible inputs of a model. The numbers are internal; files use the names of features.
enum class ReachFeature : std::uint8_t {
  D1 = 1,          ///< d1_mm: P1 - P2.
  D2,              ///< d2_mm: P3 - P1.
  P1,              ///< p1_mm
  P2,              ///< p2_mm
  P3,              ///< p3_mm
  RelativeD1,      ///< d1_of_p1: d1 / P1, independent of the body weight.
  RelativeD2,      ///< d2_of_p1
  RelativeHold,    ///< hold_of_p1
  Rise,            ///< rise_s
  RestRatio,       ///< rest_ratio: where the person sits.
  RatioChange,     ///< ratio_change: how far the centre of pressure moved forward.
  OwnD1,           ///< d1_of_own_max: d1 / d2 of the subject's own maximum reaches. This and the following features need a
                   ///< SubjectCalibration.
  OwnD2,           ///< d2_of_own_max
  OwnHold,         ///< hold_of_own_max
  OwnRatioChange,  ///< ratio_change_of_own_max
};

/// Returns for example "d2_of_p1".
[[nodiscard]] std::string_view name_of(ReachFeature feature) noexcept;
[[nodiscard]] std::optional<ReachFeature> parse_reach_feature(std::string_view name) noexcept;
[[nodiscard]] bool is_own(ReachFeature feature) noexcept;

/// Returns NaN if the value is unknown. Realtime-safe: yes.
[[nodiscard]] double value_of(ReachFeature feature, const core::ReachFeatures& reach, const SubjectCalibration* subject) noexcept;

/// A feature and its range in the training data, which is scaled to [-1, 1].
struct FeatureRange {
  ReachFeature feature = ReachFeature::D1;
  double minimum = 0.0;
  double maximum = 1.0;

  [[nodiscard]] double scaled(double value) const noexcept { return 2.0 * (value - minimum) / (maximum - minimum) - 1.0; }
  friend bool operator==(const FeatureRange&, const FeatureRange&) = default;
};

}  // namespace dts::classifier
