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
constexpr core::Millimetres kBetweenHalves{45.0};  // half the width of the forefoot

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
  const bool has_width = stance.kind != ContactKind::Feet || stance.width.value > 0.0;
  if (stance.kind != ContactKind::Point && !(has_width && stance.foot_length.value > 0.0)) {
    return core::fail(ErrorCode::InvalidArgument,
                      "stance: width of " + mm(stance.width) + " and foot length of " + mm(stance.foot_length) + " must both be positive");
  }
  return {};
}

/// `between` is the distance between the centres of the left and right patches, each `part` of a foot wide.
StancePatches heels_and_forefeet(const Stance& stance, const Plate& plate, core::Millimetres between, double part) {
  StancePatches placed{.width_mm = between.value, .heel_to_forefoot_mm = kHeelToForefoot * stance.foot_length.value};
  const core::Millimetres x = plate.a / 2.0 + stance.centre_ml;
  const core::Millimetres y = plate.b / 2.0 + stance.centre_ap;
  const core::Millimetres half_length{placed.heel_to_forefoot_mm / 2.0};
  for (const double side : {-0.5, 0.5}) {
    const core::Millimetres middle = x + between * side;
    placed.patches[placed.count++] = {{middle, y - half_length}, kHeelWidth * part, kHeelLength};
    placed.patches[placed.count++] = {{middle, y + half_length}, kForefootWidth * part, kForefootLength};
  }
  return placed;
}

StancePatches point(const Stance& stance, const Plate& plate) {
  StancePatches placed{.count = 1};
  placed.patches[0] = {{plate.a / 2.0 + stance.centre_ml, plate.b / 2.0 + stance.centre_ap}, {}, {}};
  return placed;
}

StancePatches contacts(const Stance& stance, const Plate& plate) {
  switch (stance.kind) {
    case ContactKind::Feet: return heels_and_forefeet(stance, plate, stance.width, 1.0);
    case ContactKind::OneFoot: return heels_and_forefeet(stance, plate, kBetweenHalves, 0.5);
    case ContactKind::Point: break;
  }
  return point(stance, plate);
}

}  // namespace

core::Result<StancePatches> place_stance(const Stance& stance, const Plate& plate) {
  DTS_TRY(check_values(stance));
  const StancePatches placed = contacts(stance, plate);
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
