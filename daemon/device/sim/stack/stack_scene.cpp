// SPDX-License-Identifier: Apache-2.0
#include "device/sim/stack/stack_scene.h"

#include <cmath>
#include <utility>

namespace dts::device::sim {
namespace {

constexpr double kSyncV = 5.0;
constexpr double kSyncPulseS = 0.1;
constexpr double kPerMillion = 1e-6;
constexpr double kSecondsPerNanosecond = 1e-9;

double sync_v(double true_s) noexcept { return true_s - std::floor(true_s) < kSyncPulseS ? kSyncV : 0.0; }

}  // namespace

core::Result<std::unique_ptr<Scene>> StackScene::create(const StackOptions& options, const physics::RigModel& rig,
                                                        const core::Clock& clock) {
  DTS_TRY_ASSIGN(const auto person, dts::sim::StackPerson::create(options.stance, rig.plate));
  std::unique_ptr<StackScene> scene(new StackScene(options, clock, person));
  if (options.part == StackPart::Plate) {
    scene->force_plate_.emplace(*rig.force_plate, options.height_mm, options.defects);
    return scene;
  }
  DTS_TRY_ASSIGN(auto plate, LoadedPlate::create(options.mounting, rig, person.patches()));
  scene->platform_.emplace(Platform{std::move(plate), SensorBank(options.mounting, rig)});
  return scene;
}

double StackScene::true_s(std::int64_t start_ns, double time_s) const noexcept {
  const double start_s = static_cast<double>(start_ns - time_->zero_ns) * kSecondsPerNanosecond;
  return start_s + time_s * (1.0 - options_.clock_error_ppm * kPerMillion) - options_.offset_s;
}

void StackScene::restart() {
  if (platform_) platform_->plate.restart();
  static_cast<void>(person_.at(true_s(clock_.now_ns(), 0.0)));
}

void StackScene::evaluate(double time_s, std::span<double> values) noexcept {
  const double now_s = true_s(start_ns_, time_s);
  const dts::sim::StandingMoment moment = person_.at(now_s);
  const dts::sim::Contact& contact = moment.contact;
  if (platform_) {
    const auto deflection_mm = platform_->plate.bend(0, {contact.force_n.data(), person_.patches().size()});
    platform_->sensors.write_deflected(deflection_mm, {}, values);
  } else {
    force_plate_->write_volts(moment, time_s, values);
  }
  std::size_t next = options_.inputs;
  values[next++] = sync_v(now_s);
  if (!options_.has_truth) return;
  for (const double value : {contact.cop.ml_mm, contact.cop.ap_mm, moment.ml_n, moment.ap_n, contact.load_n}) values[next++] = value;
}

}  // namespace dts::device::sim
