// SPDX-License-Identifier: Apache-2.0
#include "device/sim/floor_scene.h"

#include <algorithm>

#include "device/sim/counter_random.h"

namespace dts::device::sim {
namespace {

constexpr double kExtraChannelV = 1.0;                    // about what a sensor without load gives
constexpr std::uint64_t kMountingSeed = 0x6d6f756e74ULL;  // gains and gaps must not repeat the numbers of the noise

/// Evenly in -1 .. 1.
double either_side(const CounterRandom& random, std::uint64_t n) noexcept { return 2.0 * random.uniform(n) - 1.0; }

double playing_from_s(const physics::Stance& stance) noexcept {
  return stance.step_on_s + physics::StandingPerson::kLoadingS + physics::StandingPerson::kShiftS + FloorScene::kSettleS;
}

}  // namespace

core::Result<std::unique_ptr<FloorScene>> FloorScene::create(const FloorOptions& options, const physics::RigModel& rig) {
  auto person = physics::StandingPerson::create(options.stance, rig.plate);
  if (!person) return tl::make_unexpected(person.error());
  std::unique_ptr<FloorScene> scene(new FloorScene(options, rig, *person));
  if (auto placed = scene->place_sensors(); !placed) return tl::make_unexpected(placed.error());
  return scene;
}

core::Status FloorScene::place_sensors() {
  std::vector<physics::Point> probes;
  for (std::size_t i = 0; i < options_.sensors; ++i) probes.push_back(rig_.sensors[i].position);
  const auto table = physics::InfluenceTable::create(rig_.plate, rig_.support, probes);
  if (!table) return tl::make_unexpected(table.error());
  const CounterRandom mounting(options_.seed ^ kMountingSeed);
  const std::span<const physics::Patch> patches = person_.patches();
  for (std::size_t i = 0; i < options_.sensors; ++i) {
    Sensor sensor;
    sensor.curve = &rig_.sensors[i].curve;
    sensor.gain = 1.0 + options_.gain_spread * either_side(mounting, 2 * i);
    sensor.unloaded_gap_mm = rig_.sensors[i].unloaded_gap.value + options_.gap_spread_mm * either_side(mounting, 2 * i + 1);
    for (std::size_t k = 0; k < patches.size(); ++k) sensor.mm_per_n[k] = table->under_patch_mm_per_n(i, patches[k]);
    sensors_.push_back(sensor);
  }
  return {};
}

core::Status FloorScene::load() {
  if (options_.cop_file.empty()) return {};
  auto recording = CopRecording::load(options_.cop_file);
  if (!recording) return tl::make_unexpected(recording.error());
  physics::Stance stance = options_.stance;
  if (!options_.is_cop_repeated) stance.step_off_s = std::min(stance.step_off_s, playing_from_s(stance) + recording->duration_s());
  auto person = physics::StandingPerson::create(stance, rig_.plate);
  if (!person) return tl::make_unexpected(person.error());
  recording_ = std::move(*recording);
  person_ = *person;
  return {};
}

void FloorScene::restart() { sway_.emplace(options_.seed); }

physics::CopPosition FloorScene::wanted_cop(double time_s) noexcept {
  if (!recording_) return sway_->at(time_s);
  const double since_first_row_s = time_s - playing_from_s(options_.stance);
  return options_.is_cop_repeated ? recording_->repeated_at(since_first_row_s) : recording_->at(since_first_row_s);
}

void FloorScene::evaluate(double time_s, std::span<double> values) noexcept {
  const physics::Contact contact = person_.at(time_s, wanted_cop(time_s));
  std::size_t next = 0;
  for (const Sensor& sensor : sensors_) {
    double deflection_mm = 0.0;
    for (std::size_t k = 0; k < contact.force_n.size(); ++k) deflection_mm += contact.force_n[k] * sensor.mm_per_n[k];
    values[next++] = sensor.gain * sensor.curve->volts(core::Millimetres{sensor.unloaded_gap_mm - deflection_mm}).value;
  }
  for (std::size_t i = 0; i < options_.extra; ++i) values[next++] = kExtraChannelV;
  if (!options_.has_truth) return;
  values[next++] = contact.cop.ml_mm;
  values[next++] = contact.cop.ap_mm;
  values[next] = contact.load_n;
}

}  // namespace dts::device::sim
