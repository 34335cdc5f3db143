// SPDX-License-Identifier: Apache-2.0
#include "report/recorded_definitions.h"

#include <cmath>
#include <utility>

#include "files/protocol_file.h"
#include "files/rig_file.h"

namespace dts::report {
namespace {

constexpr double kLargestPlateMm = 100'000.0;

}  // namespace

RecordedRig recorded_rig(const record::SessionFacts& facts) {
  if (facts.rig_definition.empty()) return {};
  files::Problems problems;
  const auto config = files::read_rig_text(facts.rig_definition, "the recorded rig", problems);
  const PlateSize plate{.a_mm = config.model.plate.a.value, .b_mm = config.model.plate.b.value};
  const auto is_plate = [](double mm) { return std::isfinite(mm) && mm > 0.0 && mm < kLargestPlateMm; };
  if (!problems.empty() || !is_plate(plate.a_mm) || !is_plate(plate.b_mm)) return {};
  return {.plate = plate,
          .is_force_plate = config.model.force_plate.has_value(),
          .corrects_two_feet = config.cop_calibration && config.cop_calibration->two_feet};
}

std::optional<classifier::TrunkModel> recorded_trunk_model(const record::SessionFacts& facts) {
  if (facts.rig_definition.empty()) return std::nullopt;
  files::Problems problems;
  auto config = files::read_rig_text(facts.rig_definition, "the recorded rig", problems);
  if (!problems.empty()) return std::nullopt;
  return std::move(config.trunk_model);
}

session::Protocol recorded_protocol(const record::SessionFacts& facts) {
  files::Problems ignored;
  return files::read_protocol_text(facts.protocol_definition, "the recorded protocol", ignored);
}

std::uint32_t planned_trials(const record::SessionFacts& facts) { return files::planned_trials(facts.protocol_definition); }

}  // namespace dts::report
