// SPDX-License-Identifier: Apache-2.0
#include "physics/stance.h"

#include <cmath>
#include <string>

namespace dts::physics {
namespace {

using core::ErrorCode;

// Assumed foot: the heel's pressure centre is 15 % and the ball's 70 % of the foot length from the end of the heel.
constexpr double kHeelToForefoot = 0.55;
constexpr core::Millimetres kHeelWidth{60.0};
constexpr core::Millimetres kHeelLength{60.0};
constexpr core::Millimetres kForefootWidth{90.0};
constexpr core::Millimetres kForefootLength{70.0};

bool is_on_plate(const Patch& patch, const Plate& plate) noexcept {
  const double half_width = patch.width.value / 2.0;
  const double half_height = patch.height.value / 2.0;
  return patch.centre.x.value - half_width >= 0.0 && patch.centre.x.value + half_width <= plate.a.value &&
         patch.centre.y.value - half_height >= 0.0 && patch.centre.y.value + half_height <= plate.b.value;
}

std::string mm(core::Millimetres length) { return std::to_string(length.value) + " mm"; }

core::Status check_values(const Stance& stance) {
  if (!(stance.load.value > 0.0) || !std::isfinite(stance.load.value)) {
    return core::fail(ErrorCode::InvalidArgument, "stance: load of " + std::to_string(stance.load.value) + " N is not positive");
  }
  const bool has_shape = stance.width.value > 0.0 && stance.foot_length.value > 0.0;
  if (stance.kind == ContactKind::Feet && !has_shape) {
    return core::fail(ErrorCode::InvalidArgument,
                      "stance: width of " + mm(stance.width) + " and foot length of " + mm(stance.foot_length) + " must both be positive");
  }
  return {};
}

StancePatches feet(const Stance& stance, const Plate& plate) {
  StancePatches placed{.heel_to_forefoot_mm = kHeelToForefoot * stance.foot_length.value};
  const core::Millimetres x = plate.a / 2.0 + stance.centre_ml;
  const core::Millimetres y = plate.b / 2.0 + stance.centre_ap;
  const core::Millimetres half_length{placed.heel_to_forefoot_mm / 2.0};
  for (const double side : {-0.5, 0.5}) {
    const core::Millimetres foot = x + stance.width * side;
    placed.patches[placed.count++] = {{foot, y - half_length}, kHeelWidth, kHeelLength};
    placed.patches[placed.count++] = {{foot, y + half_length}, kForefootWidth, kForefootLength};
  }
  return placed;
}

StancePatches point(const Stance& stance, const Plate& plate) {
  StancePatches placed{.count = 1};
  placed.patches[0] = {{plate.a / 2.0 + stance.centre_ml, plate.b / 2.0 + stance.centre_ap}, {}, {}};
  return placed;
}

}  // namespace

core::Result<StancePatches> place_stance(const Stance& stance, const Plate& plate) {
  DTS_TRY(check_values(stance));
  const StancePatches placed = stance.kind == ContactKind::Feet ? feet(stance, plate) : point(stance, plate);
  for (const Patch& patch : placed.used()) {
    if (is_on_plate(patch, plate)) continue;
    return core::fail(ErrorCode::InvalidArgument,
                      "stance: a contact at x " + mm(patch.centre.x) + ", y " + mm(patch.centre.y) +
                          " (from the corner) does not fit on the " + mm(plate.a) + " x " + mm(plate.b) + " plate",
                      "stand closer to the centre or narrower");
  }
  return placed;
}

}  // namespace dts::physics
