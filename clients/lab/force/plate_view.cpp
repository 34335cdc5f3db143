// SPDX-License-Identifier: Apache-2.0
#include "lab/force/plate_view.h"

#include <cmath>

namespace dts::lab::force {
namespace {

Vector difference(const Vector& a, const Vector& b) noexcept { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Vector cross(const Vector& a, const Vector& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

std::optional<Vector> unit(const Vector& vector) noexcept {
  const double length = std::hypot(vector[0], vector[1], vector[2]);
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  return Vector{vector[0] / length, vector[1] / length, vector[2] / length};
}

}  // namespace

Vector PlatePlace::turned(const Vector& of_plate) const noexcept {
  Vector sum{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (axes[axis][k] != 0.0) sum[k] += axes[axis][k] * of_plate[axis];  // an absent component leaves the others
    }
  }
  return sum;
}

std::optional<PlatePlace> place_of(const PlateFacts& plate) {
  if (!plate.corners_mm) return std::nullopt;
  const c3d::Corners& corners = *plate.corners_mm;
  const auto x = unit(difference(corners[0], corners[1]));
  if (!x) return std::nullopt;
  const auto z = unit(cross(*x, difference(corners[0], corners[3])));
  if (!z) return std::nullopt;
  PlatePlace place{.axes = {*x, cross(*z, *x), *z}};
  for (const auto& corner : corners) {
    for (std::size_t k = 0; k < 3; ++k) place.centre_mm[k] += corner[k] / 4.0;
  }
  return place;
}

PlateView::PlateView(const ForceFile& file, std::size_t plate, Axes axes, double least_force_n)
    : file_(&file),
      plate_(plate),
      least_force_n_(least_force_n),
      is_turned_(axes == Axes::Laboratory && file.axes == Axes::Plate),
      place_(place_of(file.plates[plate])) {}

bool PlateView::is_loaded(const ForceSample& of_file) const noexcept {
  const PlateFacts& plate = file_->plates[plate_];
  if (!plate.has_force) return plate.is_usable;
  const double force_n = of_file.force_n[file_->vertical];
  return force_n != 0.0 && std::abs(force_n) >= least_force_n_;  // false if the force is not known
}

ForceSample PlateView::in_axes(ForceSample of_file) const {
  if (!is_turned_) return of_file;
  if (!place_) return {};
  of_file.force_n = place_->turned(of_file.force_n);
  of_file.moment_nm = place_->turned(of_file.moment_nm);
  of_file.cop_mm = place_->turned(of_file.cop_mm);
  for (std::size_t k = 0; k < 3; ++k) of_file.cop_mm[k] += place_->centre_mm[k];
  return of_file;
}

ForceSample PlateView::at(std::size_t sample) const {
  ForceSample seen = file_->sample_at(plate_, sample);
  if (!is_loaded(seen)) {
    seen.cop_mm = ForceSample{}.cop_mm;
    seen.free_moment_nm = core::kNaN;
  }
  return in_axes(seen);
}

std::optional<ForceSample> PlateView::loaded_at(std::size_t sample) const {
  const ForceSample of_file = file_->sample_at(plate_, sample);
  return is_loaded(of_file) ? std::optional(in_axes(of_file)) : std::nullopt;
}

}  // namespace dts::lab::force
