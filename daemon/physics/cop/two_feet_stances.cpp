// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "physics/body/two_link.h"
#include "physics/cop/two_feet_fit.h"
#include "physics/cop/uniform_random.h"

namespace dts::physics {
namespace {

// The library of sheet two-feet. Lengths along a foot are parts of its length, from the end of the heel.
constexpr Interval kWeightKg{45.0, 110.0};
constexpr Interval kWidthMm{110.0, 260.0};
constexpr Interval kFootLengthMm{220.0, 290.0};
constexpr Interval kCentreMlMm{-20.0, 20.0};
constexpr Interval kCentreApMm{-25.0, 25.0};
constexpr Interval kLeftShare{0.38, 0.62};
constexpr double kLeftShareSd = 0.05;
constexpr Interval kHeelShare{0.35, 0.65};
constexpr Interval kMidfootShare{0.0, 0.12};
constexpr Interval kToeOutDeg{0.0, 15.0};
constexpr Interval kFeetApartMm{-4.0, 4.0};  ///< How far the left foot is in front of the right one.
constexpr Interval kHeelPlace{0.10, 0.18};
constexpr double kMidfootPlace = 0.42;
constexpr Interval kForefootPlace{0.64, 0.80};
constexpr Interval kPatchSideMm{35.0, 95.0};
constexpr double kFootCentre = 0.5;  ///< The centre of the stance.
constexpr std::size_t kSwayPositions = 6;
constexpr double kSwayMlMm = 16.0;
constexpr double kSwayApMm = 20.0;
constexpr Interval kPossibleShare{0.05, 0.95};

double draw(UniformRandom& random, const Interval& range) { return random(range.lowest, range.highest); }

double draw_normal(UniformRandom& random, double mean, double sd, const Interval& limits) {
  while (true) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - random(0.0, 1.0)));  // Box-Muller
    const double value = mean + sd * radius * std::cos(2.0 * std::numbers::pi * random(0.0, 1.0));
    if (limits.contains(value)) return value;
  }
}

constexpr std::size_t kFootPatches = 3;  // heel, midfoot, forefoot

struct Foot {
  std::array<Patch, kFootPatches> patches;
  double midfoot_share = 0.0;
  double heel_to_forefoot_mm = 0.0;
};

/// Returns the part of a patch that is on the plate: only this part carries load.
Patch on_plate(const Patch& patch, const Plate& plate) {
  const auto cut = [](core::Millimetres centre, core::Millimetres side, core::Millimetres length) {
    const double from = std::max(0.0, centre.value - 0.5 * side.value);
    const double to = std::min(length.value, centre.value + 0.5 * side.value);
    return std::pair(core::Millimetres{0.5 * (from + to)}, core::Millimetres{to - from});
  };
  const auto [x, width] = cut(patch.centre.x, patch.width, plate.a);
  const auto [y, height] = cut(patch.centre.y, patch.height, plate.b);
  return {.centre = {x, y}, .width = width, .height = height};
}

/// Draws a foot around `centre`; `side` is -1 for the left foot and 1 for the right one.
Foot draw_foot(UniformRandom& random, Point centre, double side, double length_mm) {
  const std::array places{draw(random, kHeelPlace), kMidfootPlace, draw(random, kForefootPlace)};
  const double toe_out = draw(random, kToeOutDeg) * std::numbers::pi / 180.0;
  Foot foot{.patches = {}, .midfoot_share = draw(random, kMidfootShare), .heel_to_forefoot_mm = (places[2] - places[0]) * length_mm};
  for (std::size_t k = 0; k < kFootPatches; ++k) {
    const double along_mm = (places[k] - kFootCentre) * length_mm;
    const Point middle{centre.x + core::Millimetres{side * std::sin(toe_out) * along_mm},
                       centre.y + core::Millimetres{std::cos(toe_out) * along_mm}};
    foot.patches[k] = {.centre = middle, .width = {draw(random, kPatchSideMm)}, .height = {draw(random, kPatchSideMm)}};
  }
  return foot;
}

void add_loads(CopTrial& trial, const Foot& foot, double load_n, double heel_share) {
  const double rest = 1.0 - foot.midfoot_share;
  const std::array shares{rest * heel_share, foot.midfoot_share, rest * (1.0 - heel_share)};
  for (std::size_t k = 0; k < kFootPatches; ++k) trial.loads.push_back({.area = foot.patches[k], .force = {load_n * shares[k]}});
}

bool is_on_plate(const Foot& foot, const Plate& plate) {
  return std::ranges::all_of(foot.patches, [&](const Patch& patch) {
    const auto& [x, y] = patch.centre;
    return x.value > 0.0 && x < plate.a && y.value > 0.0 && y < plate.b;
  });
}

}  // namespace

std::vector<TwoFeetStance> two_feet_stances(const Plate& plate, std::size_t count, std::uint64_t seed) {
  UniformRandom random(seed);
  std::vector<TwoFeetStance> stances;
  for (std::size_t attempt = 0; stances.size() < count && attempt < 10 * count; ++attempt) {
    const double load_n = draw(random, kWeightKg) * kGravityMPerS2;
    TwoFeetStance stance{.width_mm = draw(random, kWidthMm)};
    stance.stated_width_mm = stance.width_mm + random(-kWidthErrorMm, kWidthErrorMm);
    const double length_mm = draw(random, kFootLengthMm);
    const Point centre{plate.a / 2.0 + core::Millimetres{draw(random, kCentreMlMm)},
                       plate.b / 2.0 + core::Millimetres{draw(random, kCentreApMm)}};
    const double apart_mm = draw(random, kFeetApartMm);
    const auto middle_of = [&](double side) {
      return Point{centre.x + core::Millimetres{side * 0.5 * stance.width_mm}, centre.y - core::Millimetres{side * 0.5 * apart_mm}};
    };
    Foot left = draw_foot(random, middle_of(-1.0), -1.0, length_mm);
    Foot right = draw_foot(random, middle_of(1.0), 1.0, length_mm);
    const double left_share = draw_normal(random, 0.5, kLeftShareSd, kLeftShare);
    const double heel_share = draw(random, kHeelShare);
    std::array<std::pair<double, double>, kSwayPositions + 1> sway_mm{};  // the first one is the mean position
    for (std::size_t k = 1; k < sway_mm.size(); ++k) sway_mm[k] = {random(-kSwayMlMm, kSwayMlMm), random(-kSwayApMm, kSwayApMm)};
    if (!is_on_plate(left, plate) || !is_on_plate(right, plate)) continue;
    for (Foot* foot : {&left, &right}) {
      for (Patch& patch : foot->patches) patch = on_plate(patch, plate);
    }
    for (const auto& [ml_mm, ap_mm] : sway_mm) {
      const double left_part = kPossibleShare.clamp(left_share - ml_mm / stance.width_mm);
      const double heel_part = kPossibleShare.clamp(heel_share - ap_mm / left.heel_to_forefoot_mm);
      CopTrial trial;
      add_loads(trial, left, load_n * left_part, heel_part);
      add_loads(trial, right, load_n * (1.0 - left_part), heel_part);
      trial.centre = centre_of(trial.loads);
      stance.positions.push_back(std::move(trial));
    }
    stances.push_back(std::move(stance));
  }
  return stances;
}

}  // namespace dts::physics
