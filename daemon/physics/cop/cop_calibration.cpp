// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_calibration.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "physics/cop/cop_fit.h"
#include "physics/cop/cop_least_squares.h"

namespace dts::physics {
namespace {

/// FNV-1a over the method and the bits of every value, folded to 32 bits.
std::uint32_t checksum(CopMethod method, std::span<const CopSample> samples) {
  std::uint64_t hash = 0xcbf29ce484222325U;
  const auto add = [&hash](double value) {
    const auto bits = std::bit_cast<std::uint64_t>(value);
    for (int shift = 0; shift < 64; shift += 8) hash = (hash ^ ((bits >> shift) & 0xffU)) * 0x100000001b3U;
  };
  add(static_cast<double>(method));
  for (const CopSample& sample : samples) {
    add(sample.load_position.x.value);
    add(sample.load_position.y.value);
    add(sample.load.value);
    std::ranges::for_each(sample.deflection_mm, add);
  }
  return static_cast<std::uint32_t>(hash ^ (hash >> 32));
}

std::string make_id(const std::string& created_utc, CopMethod method, std::span<const CopSample> samples) {
  std::string id = "cop-";
  std::ranges::copy_if(created_utc, std::back_inserter(id), [](char character) { return character != '-' && character != ':'; });
  std::array<char, 16> sum{};
  std::snprintf(sum.data(), sum.size(), "-%08x", checksum(method, samples));
  return id + sum.data();
}

}  // namespace

bool is_utc_time(std::string_view text) noexcept {
  constexpr std::string_view kForm = "dddd-dd-ddTdd:dd:ddZ";
  return text.size() == kForm.size() && std::equal(text.begin(), text.end(), kForm.begin(), [](char character, char wanted) {
           return wanted == 'd' ? character >= '0' && character <= '9' : character == wanted;
         });
}

CopCalibrationPoint compare(const CopSample& sample, const CopEstimate& estimate) {
  return {.sample = sample,
          .x_error_mm = estimate.x_mm - sample.load_position.x.value,
          .y_error_mm = estimate.y_mm - sample.load_position.y.value,
          .load_error_percent = 100.0 * (estimate.load_n / sample.load.value - 1.0)};
}

CopErrorFigures error_figures(std::span<const CopCalibrationPoint> points) {
  CopErrorFigures figures;
  if (points.empty()) return figures;
  for (const CopCalibrationPoint& point : points) {
    figures.rms_x_mm += point.x_error_mm * point.x_error_mm;
    figures.rms_y_mm += point.y_error_mm * point.y_error_mm;
    figures.load_rms_percent += point.load_error_percent * point.load_error_percent;
    figures.max_total_mm = std::max(figures.max_total_mm, std::hypot(point.x_error_mm, point.y_error_mm));
  }
  const auto count = static_cast<double>(points.size());
  figures.rms_total_mm = std::sqrt((figures.rms_x_mm + figures.rms_y_mm) / count);
  figures.rms_x_mm = std::sqrt(figures.rms_x_mm / count);
  figures.rms_y_mm = std::sqrt(figures.rms_y_mm / count);
  figures.load_rms_percent = std::sqrt(figures.load_rms_percent / count);
  return figures;
}

core::Result<CopCalibration> calibrate_cop(CopMethod method, std::span<const CopSample> samples, CopCalibrationOrigin origin) {
  if (!is_utc_time(origin.created_utc)) {
    return refuse_calibration("the date '" + origin.created_utc + "' is not like 2026-01-31T12:00:00Z");
  }
  DTS_TRY_ASSIGN(auto fitted, fit_cop(method, samples));
  const std::vector<CopEstimate> left_out = fitted.left_out;
  DTS_TRY_ASSIGN(auto estimator, accept(method, std::move(fitted), samples));

  std::vector<CopCalibrationPoint> points;
  std::vector<CopCalibrationPoint> checked;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    points.push_back(compare(samples[k], estimator.estimate(samples[k].deflection_mm)));
    if (k < left_out.size() && std::isfinite(left_out[k].x_mm)) checked.push_back(compare(samples[k], left_out[k]));
  }
  CopCalibration calibration{.id = make_id(origin.created_utc, method, samples),
                             .origin = std::move(origin),
                             .estimator = std::move(estimator),
                             .points = std::move(points),
                             .residuals = {},
                             .cross_validated = {}};
  calibration.residuals = error_figures(calibration.points);
  if (2 * checked.size() > samples.size()) calibration.cross_validated = error_figures(checked);
  return calibration;
}

}  // namespace dts::physics
