// SPDX-License-Identifier: Apache-2.0
#include "device/usb/start_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace dts::device::usb {
namespace {

constexpr double kClearlyBetter = 0.5;

/// Returns the sum of differences if scan position i + `rotation` contains channel i.
double misfit(std::span<const double> single_v, std::span<const double> scan_v, std::size_t rotation) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < single_v.size(); ++i) sum += std::abs(scan_v[(i + rotation) % scan_v.size()] - single_v[i]);
  return sum;
}

}  // namespace

Agreement compare_with_single_readings(std::span<const double> single_v, std::span<const double> scan_v) noexcept {
  Agreement result;
  if (single_v.empty() || single_v.size() != scan_v.size()) return result;
  for (std::size_t i = 0; i < single_v.size(); ++i) {
    const double difference_v = std::abs(scan_v[i] - single_v[i]);
    if (!(difference_v > result.worst_difference_v)) continue;
    result.worst_difference_v = difference_v;
    result.worst_channel = i;
  }
  const double as_it_is = misfit(single_v, scan_v, 0);
  if (!(as_it_is > kAgreementToleranceV * static_cast<double>(single_v.size()))) return result;  // also for NaN
  result.is_different = true;
  double best = as_it_is * kClearlyBetter;
  for (std::size_t rotation = 1; rotation < single_v.size(); ++rotation) {
    const double sum = misfit(single_v, scan_v, rotation);
    if (!(sum < best)) continue;
    best = sum;
    result.is_rotated = true;
    result.rotation = rotation;
  }
  return result;
}

DeviceCheck describe_agreement(const Agreement& agreement, const DeviceDescription& description) {
  const std::string channel =
      agreement.worst_channel < description.channels.size() ? description.channels[agreement.worst_channel].name : "?";
  std::array<char, 96> difference{};
  std::snprintf(difference.data(), difference.size(), "largest difference %.0f mV on ", agreement.worst_difference_v * 1e3);
  DeviceCheck check{"single readings agree with the scan", DeviceCheck::Outcome::Passed, difference.data() + channel};
  if (agreement.is_rotated) {
    check.outcome = DeviceCheck::Outcome::Failed;
    check.detail = "the channels are rotated by " + std::to_string(agreement.rotation) + "; " + check.detail;
  } else if (agreement.is_different) {
    check.outcome = DeviceCheck::Outcome::Warning;
    check.detail += ": check whether something moved meanwhile";
  }
  return check;
}

}  // namespace dts::device::usb
