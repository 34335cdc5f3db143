// SPDX-License-Identifier: Apache-2.0
#include "sim/seat_plate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "physics/plate/influence_table.h"
#include "sim/navier.h"

namespace dts::sim {
namespace {

using core::Millimetres;

constexpr double kLargestContactMm = 1000.0;

physics::Patch whole(const physics::Plate& plate) {
  return {.centre = {plate.a / 2.0, plate.b / 2.0}, .width = plate.a, .height = plate.b};
}

physics::Patch patch_at(const physics::Plate& plate, const SeatContact& contact, double y_mm) {
  return {.centre = {plate.a / 2.0 + Millimetres{contact.off_centre_mm}, Millimetres{y_mm}},
          .width = Millimetres{contact.width_mm},
          .height = Millimetres{contact.depth_mm}};
}

/// Returns the fraction of a patch's side that is on the plate.
double part_within(double centre_mm, double side_mm, double plate_mm) noexcept {
  const double from = std::max(centre_mm - side_mm / 2.0, 0.0);
  const double to = std::min(centre_mm + side_mm / 2.0, plate_mm);
  return std::max(to - from, 0.0) / side_mm;
}

core::Status check_contact(const SeatContact& contact) {
  const bool has_size = contact.width_mm > 0.0 && contact.width_mm <= kLargestContactMm && contact.depth_mm > 0.0 &&
                        contact.depth_mm <= kLargestContactMm && std::abs(contact.off_centre_mm) <= kLargestContactMm;
  if (has_size) return {};
  return core::fail(core::ErrorCode::InvalidArgument, "the contact of " + std::to_string(contact.width_mm) + " x " +
                                                          std::to_string(contact.depth_mm) + " mm does not fit on a seat");
}

}  // namespace

core::Result<SeatPlate> SeatPlate::create(const physics::Plate& plate, const physics::Support& support,
                                          std::span<const physics::Point> probes, const SeatContact& contact) {
  for (const auto& status : {physics::check_plate(plate), check_support(plate, support), check_contact(contact)}) {
    if (!status) return tl::make_unexpected(status.error());
  }
  for (std::size_t k = 0; k < probes.size(); ++k) {
    DTS_TRY(check_on_plate(plate, probes[k], "probe " + std::to_string(k)));
  }
  SeatPlate seat;
  seat.first_mm_ = -contact.depth_mm / 2.0;
  seat.rows_ = static_cast<std::size_t>(std::ceil((plate.b.value + contact.depth_mm) / kStepMm)) + 2;
  seat.mm_per_n_.resize(seat.rows_ * probes.size());
  if (support.kind == physics::SupportKind::Edges) {
    seat.tabulate_series(plate, probes, contact);
    return seat;
  }
  DTS_TRY(seat.tabulate_grid(plate, support, probes, contact));
  return seat;
}

void SeatPlate::tabulate_series(const physics::Plate& plate, std::span<const physics::Point> probes, const SeatContact& contact) {
  constexpr double kSquareMillimetres = 1e6;
  const double pa_per_n = kSquareMillimetres / (contact.width_mm * contact.depth_mm);
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const physics::Patch patch = patch_at(plate, contact, 0.0);
    const NavierStrip strip(plate, probes[k], patch.centre.x - patch.width / 2.0, patch.centre.x + patch.width / 2.0);
    for (std::size_t row = 0; row < rows_; ++row) {
      const Millimetres middle{first_mm_ + static_cast<double>(row) * kStepMm};
      mm_per_n_[row * probes.size() + k] = pa_per_n * strip.mm_per_pa(middle - patch.height / 2.0, middle + patch.height / 2.0);
    }
    uniform_mm_per_n_.push_back(navier_mm_per_n(plate, probes[k], whole(plate)));
  }
}

core::Status SeatPlate::tabulate_grid(const physics::Plate& plate, const physics::Support& support, std::span<const physics::Point> probes,
                                      const SeatContact& contact) {
  DTS_TRY_ASSIGN(const auto table, physics::InfluenceTable::create(plate, support, probes));
  const double across = part_within(plate.a.value / 2.0 + contact.off_centre_mm, contact.width_mm, plate.a.value);
  for (std::size_t row = 0; row < rows_; ++row) {
    const double y_mm = first_mm_ + static_cast<double>(row) * kStepMm;
    const double part = across * part_within(y_mm, contact.depth_mm, plate.b.value);
    for (std::size_t k = 0; k < probes.size() && part > 0.0; ++k) {
      mm_per_n_[row * probes.size() + k] = part * table.under_patch_mm_per_n(k, patch_at(plate, contact, y_mm));
    }
  }
  for (std::size_t k = 0; k < probes.size(); ++k) uniform_mm_per_n_.push_back(table.under_patch_mm_per_n(k, whole(plate)));
  return {};
}

void SeatPlate::deflect(const SeatLoad& load, std::span<double> mm) const noexcept {
  const std::size_t count = std::min(mm.size(), uniform_mm_per_n_.size());
  if (load.is_uniform) {
    for (std::size_t k = 0; k < count; ++k) mm[k] = load.force_n * uniform_mm_per_n_[k];
    return;
  }
  if (!std::isfinite(load.y_mm)) {
    std::fill_n(mm.begin(), count, load.y_mm);
    return;
  }
  const double place = std::clamp((load.y_mm - first_mm_) / kStepMm, 0.0, static_cast<double>(rows_ - 2));
  const auto row = std::min(static_cast<std::size_t>(place), rows_ - 2);
  const double part = place - static_cast<double>(row);
  const double* near = mm_per_n_.data() + row * uniform_mm_per_n_.size();
  const double* far = near + uniform_mm_per_n_.size();
  for (std::size_t k = 0; k < count; ++k) mm[k] = load.force_n * (near[k] + part * (far[k] - near[k]));
}

}  // namespace dts::sim
