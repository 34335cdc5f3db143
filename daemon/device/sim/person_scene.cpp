// SPDX-License-Identifier: Apache-2.0
#include "device/sim/person_scene.h"

#include <algorithm>

namespace dts::device::sim {
namespace {

double playing_from_s(const physics::Stance& stance) noexcept {
  return stance.step_on_s + dts::sim::StandingPerson::kLoadingS + dts::sim::StandingPerson::kShiftS + PersonScene::kSettleS;
}

}  // namespace

core::Result<std::unique_ptr<Scene>> PersonScene::create(const FloorOptions& options, const physics::RigModel& rig) {
  if (!options.cop_file.empty()) {  // only a check, so that a wrong file is found now; `load` reads it again
    const auto recording = CopRecording::load(options.cop_file);
    if (!recording) return tl::make_unexpected(recording.error());
  }
  DTS_TRY_ASSIGN(auto person, dts::sim::StandingPerson::create(options.stance, rig.plate));
  DTS_TRY_ASSIGN(auto plate, LoadedPlate::create(options, rig, person.patches()));
  return std::unique_ptr<Scene>(new PersonScene(options, rig, person, std::move(plate)));
}

core::Status PersonScene::load() {
  if (options_.cop_file.empty()) return {};
  DTS_TRY_ASSIGN(auto recording, CopRecording::load(options_.cop_file));
  physics::Stance stance = options_.stance;
  if (!options_.is_repeated) stance.step_off_s = std::min(stance.step_off_s, playing_from_s(stance) + recording.duration_s());
  DTS_TRY_ASSIGN(auto person, dts::sim::StandingPerson::create(stance, rig_.plate));
  recording_ = std::move(recording);
  person_ = person;
  return {};
}

void PersonScene::restart() {
  plate_.restart();
  sway_.emplace(options_.seed, options_.contact == FloorContact::OneFoot ? dts::sim::kOneFootSway : dts::sim::kTwoFeetSway);
}

dts::sim::CopPosition PersonScene::wanted_cop(double time_s) noexcept {
  if (!recording_) return sway_->at(time_s);
  const double since_first_row_s = time_s - playing_from_s(options_.stance);
  return options_.is_repeated ? recording_->repeated_at(since_first_row_s) : recording_->at(since_first_row_s);
}

void PersonScene::evaluate(double time_s, std::span<double> values) noexcept {
  const dts::sim::Contact contact = person_.at(time_s, wanted_cop(time_s));
  const auto deflection_mm = plate_.bend(0, {contact.force_n.data(), person_.patches().size()});
  sensors_.write_deflected(deflection_mm, {contact.cop.ml_mm, contact.cop.ap_mm, contact.load_n}, values);
}

}  // namespace dts::device::sim
