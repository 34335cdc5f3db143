// SPDX-License-Identifier: Apache-2.0
#include "physics/cop/cop_trials.h"

#include <algorithm>

#include "physics/cop/uniform_random.h"
#include "physics/stance.h"

namespace dts::physics {
namespace {

/// Returns `count` evenly spaced values from `first` to `last`.
std::vector<core::Millimetres> evenly(core::Millimetres first, core::Millimetres last, std::size_t count) {
  std::vector<core::Millimetres> values;
  values.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    values.push_back(first + (last - first) * (static_cast<double>(k) / static_cast<double>(count - 1)));
  }
  return values;
}

// Positions of people on a plate of 430 mm: one foot near the middle, or two beside it. Chosen by hand so that the four-sensor estimator
// has the errors of the study of plate-model section 6, whose stances are not documented.
constexpr double kOneFootWanderMm = 38.0;
constexpr double kTwoFeetWanderMm = 35.0;
constexpr core::Millimetres kNoWidth{1.0};  ///< The unloaded foot is beside the other one.
constexpr double kNarrowestMm = 120.0;
constexpr double kWidestMm = 240.0;
constexpr double kShortestFootMm = 230.0;
constexpr double kLongestFootMm = 280.0;
constexpr double kLean = 0.2;  ///< Largest deviation from one half of the shares of a foot and of the forefoot.

}  // namespace

SensorRectangle SensorRectangle::of(const RigModel& rig) {
  const auto& w = rig.sensors;
  if (w.size() == 4) {
    return {(w[0].position.x + w[2].position.x) / 2, (w[1].position.x + w[3].position.x) / 2, (w[0].position.y + w[1].position.y) / 2,
            (w[2].position.y + w[3].position.y) / 2};
  }
  const auto [left, right] = std::ranges::minmax(w, {}, [](const SensorModel& sensor) { return sensor.position.x; });
  const auto [bottom, top] = std::ranges::minmax(w, {}, [](const SensorModel& sensor) { return sensor.position.y; });
  return {left.position.x, right.position.x, bottom.position.y, top.position.y};
}

Point centre_of(std::span<const PlateLoad> loads) {
  double sum_n = 0.0;
  Point moment;
  for (const PlateLoad& load : loads) {
    sum_n += load.force.value;
    moment.x = moment.x + load.area.centre.x * load.force.value;
    moment.y = moment.y + load.area.centre.y * load.force.value;
  }
  return {moment.x / sum_n, moment.y / sum_n};
}

std::vector<Point> table_41_positions() {
  constexpr double kFirstMm = 86.0;
  constexpr double kStepMm = 32.25;
  std::vector<Point> positions;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column <= row; ++column) positions.push_back({{kFirstMm + column * kStepMm}, {kFirstMm + row * kStepMm}});
  }
  return positions;
}

std::vector<Point> mid_line_positions(const SensorRectangle& area) {
  std::vector<Point> positions;
  for (const auto x : evenly(area.left, area.right, 5)) positions.push_back({x, area.centre().y});
  for (const auto y : evenly(area.bottom, area.top, 5)) positions.push_back({area.centre().x, y});
  return positions;
}

std::vector<Point> grid_positions(const SensorRectangle& area, std::size_t count) {
  std::vector<Point> positions;
  for (const auto y : evenly(area.bottom, area.top, count)) {
    for (const auto x : evenly(area.left, area.right, count)) positions.push_back({x, y});
  }
  return positions;
}

std::vector<CopTrial> point_trials(std::span<const Point> positions, std::span<const double> loads_n) {
  std::vector<CopTrial> trials;
  trials.reserve(positions.size() * loads_n.size());
  for (const double load_n : loads_n) {
    for (const Point& position : positions) trials.push_back({position, {{.area = {position, {}, {}}, .force = {load_n}}}});
  }
  return trials;
}

std::vector<CopTrial> foot_trials(const Plate& plate, std::size_t feet, std::size_t count, Interval load_n, std::uint64_t seed) {
  UniformRandom uniform(seed);
  std::vector<CopTrial> trials;
  for (std::size_t attempt = 0; trials.size() < count && attempt < 10 * count; ++attempt) {
    Stance stance{.load = {uniform(load_n.lowest, load_n.highest)}};
    const double wander_mm = feet == 1 ? kOneFootWanderMm : kTwoFeetWanderMm;
    stance.centre_ml = {uniform(-wander_mm, wander_mm)};
    stance.centre_ap = {uniform(-wander_mm, wander_mm)};
    stance.width = feet == 1 ? kNoWidth : core::Millimetres{uniform(kNarrowestMm, kWidestMm)};
    stance.foot_length = {uniform(kShortestFootMm, kLongestFootMm)};
    const double forefoot = uniform(0.5 - kLean, 0.5 + kLean);
    const double right = feet == 1 ? 0.0 : uniform(0.5 - kLean, 0.5 + kLean);
    const auto placed = place_stance(stance, plate);
    if (!placed) continue;  // does not fit on the plate
    const auto patches = placed->used();
    CopTrial trial;
    for (std::size_t k = 0; k < patches.size(); ++k) {
      const double part = (k < 2 ? 1.0 - right : right) * (k % 2 == 0 ? 1.0 - forefoot : forefoot);
      if (part > 0.0) trial.loads.push_back({.area = patches[k], .force = stance.load * part});
    }
    trial.centre = centre_of(trial.loads);
    trials.push_back(std::move(trial));
  }
  return trials;
}

}  // namespace dts::physics
