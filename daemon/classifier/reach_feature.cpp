// SPDX-License-Identifier: Apache-2.0
#include "classifier/reach_feature.h"

#include <limits>
#include <utility>

namespace dts::classifier {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

constexpr std::array kNames = {
    std::pair{ReachFeature::D1, std::string_view("d1_mm")},
    std::pair{ReachFeature::D2, std::string_view("d2_mm")},
    std::pair{ReachFeature::P1, std::string_view("p1_mm")},
    std::pair{ReachFeature::P2, std::string_view("p2_mm")},
    std::pair{ReachFeature::P3, std::string_view("p3_mm")},
    std::pair{ReachFeature::RelativeD1, std::string_view("d1_of_p1")},
    std::pair{ReachFeature::RelativeD2, std::string_view("d2_of_p1")},
    std::pair{ReachFeature::RelativeHold, std::string_view("hold_of_p1")},
    std::pair{ReachFeature::Rise, std::string_view("rise_s")},
    std::pair{ReachFeature::RestRatio, std::string_view("rest_ratio")},
    std::pair{ReachFeature::RatioChange, std::string_view("ratio_change")},
    std::pair{ReachFeature::OwnD1, std::string_view("d1_of_own_max")},
    std::pair{ReachFeature::OwnD2, std::string_view("d2_of_own_max")},
    std::pair{ReachFeature::OwnHold, std::string_view("hold_of_own_max")},
    std::pair{ReachFeature::OwnRatioChange, std::string_view("ratio_change_of_own_max")},
};

double part_of(double value, double whole) noexcept { return whole > 0.0 ? value / whole : kUnknown; }

double own_value(ReachFeature feature, const core::ReachFeatures& reach, const SubjectCalibration& subject) noexcept {
  switch (feature) {
    case ReachFeature::OwnD1: return part_of(reach.d1_mm(), subject.max_d2_mm);
    case ReachFeature::OwnD2: return part_of(reach.d2_mm(), subject.max_d2_mm);
    case ReachFeature::OwnHold: return part_of(reach.hold_mm, subject.max_hold_mm);
    case ReachFeature::OwnRatioChange: return part_of(reach.ratio_change, subject.max_ratio_change);
    default: return kUnknown;
  }
}

}  // namespace

std::string_view name_of(ReachFeature feature) noexcept {
  for (const auto& [known, name] : kNames) {
    if (known == feature) return name;
  }
  return "unknown";
}

std::optional<ReachFeature> parse_reach_feature(std::string_view name) noexcept {
  for (const auto& [feature, known] : kNames) {
    if (known == name) return feature;
  }
  return std::nullopt;
}

bool is_own(ReachFeature feature) noexcept { return feature >= ReachFeature::OwnD1; }

double value_of(ReachFeature feature, const core::ReachFeatures& reach, const SubjectCalibration* subject) noexcept {
  switch (feature) {
    case ReachFeature::D1: return reach.d1_mm();
    case ReachFeature::D2: return reach.d2_mm();
    case ReachFeature::P1: return reach.p1_mm;
    case ReachFeature::P2: return reach.p2_mm;
    case ReachFeature::P3: return reach.p3_mm;
    case ReachFeature::RelativeD1: return part_of(reach.d1_mm(), reach.p1_mm);
    case ReachFeature::RelativeD2: return part_of(reach.d2_mm(), reach.p1_mm);
    case ReachFeature::RelativeHold: return part_of(reach.hold_mm, reach.p1_mm);
    case ReachFeature::Rise: return reach.rise_s;
    case ReachFeature::RestRatio: return reach.rest_ratio;
    case ReachFeature::RatioChange: return reach.ratio_change;
    default: return subject == nullptr ? kUnknown : own_value(feature, reach, *subject);
  }
}

}  // namespace dts::classifier
