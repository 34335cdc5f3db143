// SPDX-License-Identifier: Apache-2.0
#include "classifier/subject_calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace dts::classifier {
namespace {

constexpr double kMinorPart = 0.05;        ///< Of P1: reach_flag::kMinor.
constexpr double kLargestDeviation = 0.3;  ///< From the median. People repeat a maximum reach within about 10 %; one of three may deviate
                                           ///< more.

/// Returns NaN if a value is NaN.
template <typename Value>
double median_of(std::span<const core::ReachFeatures> reaches, Value value) {
  std::vector<double> values;
  for (const core::ReachFeatures& reach : reaches) values.push_back(value(reach));
  if (!std::all_of(values.begin(), values.end(), [](double one) { return std::isfinite(one); })) return core::ReachFeatures::kUnknown;
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2.0;
}

core::ReachFeatures median_reach(std::span<const core::ReachFeatures> reaches) {
  core::ReachFeatures median;
  for (double core::ReachFeatures::*member :
       {&core::ReachFeatures::p1_mm, &core::ReachFeatures::p2_mm, &core::ReachFeatures::p3_mm, &core::ReachFeatures::hold_mm,
        &core::ReachFeatures::rise_s, &core::ReachFeatures::rest_ratio, &core::ReachFeatures::ratio_change, &core::ReachFeatures::twist,
        &core::ReachFeatures::smoothness}) {
    median.*member = median_of(reaches, [member](const core::ReachFeatures& reach) { return reach.*member; });
  }
  return median;
}

auto refused(const std::string& what) {
  return core::fail(core::ErrorCode::InvalidArgument, "subject calibration: " + what,
                    "record three maximum reaches at the subject's own pace, from rest against the backrest");
}

}  // namespace

core::Result<SubjectCalibration> calibrate_subject(std::span<const core::ReachFeatures> maximum_reaches, double max_flexion_deg) {
  if (maximum_reaches.size() < kCalibrationReaches) {
    return refused(std::to_string(maximum_reaches.size()) + " maximum reaches are too few, " + std::to_string(kCalibrationReaches) +
                   " are needed");
  }
  if (!(max_flexion_deg > 0.0 && max_flexion_deg <= 90.0))
    return refused("the trunk flexion of the maximum reach is not between 0 and 90 degrees");
  for (const core::ReachFeatures& reach : maximum_reaches) {
    if (!std::isfinite(reach.d2_mm()) || !std::isfinite(reach.d1_mm()) || !(reach.p1_mm > 0.0))
      return refused("a reach has no finite d1_mm and d2_mm, or no positive p1_mm");
    if (reach.d2_mm() < kMinorPart * reach.p1_mm) return refused("in one reach only the arm moved");
  }
  const double max_d2_mm = median_of(maximum_reaches, [](const core::ReachFeatures& reach) { return reach.d2_mm(); });
  const auto near = std::count_if(maximum_reaches.begin(), maximum_reaches.end(), [max_d2_mm](const core::ReachFeatures& reach) {
    return std::abs(reach.d2_mm() - max_d2_mm) <= kLargestDeviation * max_d2_mm;
  });
  if (3 * static_cast<std::size_t>(near) < 2 * maximum_reaches.size()) {
    return refused("the reaches differ too much from each other to be maximum reaches");
  }
  SubjectCalibration subject{.max_d2_mm = max_d2_mm, .max_flexion_deg = max_flexion_deg, .maximum = median_reach(maximum_reaches)};
  subject.max_hold_mm = subject.maximum.hold_mm;
  subject.max_ratio_change = subject.maximum.ratio_change;
  return subject;
}

}  // namespace dts::classifier
