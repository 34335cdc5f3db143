// SPDX-License-Identifier: Apache-2.0
// Models of trunk movement. One that is accepted is the same when written and read, and what it says of any reach is a probability.
#include <array>
#include <cmath>

#include "files/trunk_model_file.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::trunk_model {
namespace {

constexpr double kSumTolerance = 1e-9;

/// Without its checksum, which would refuse nearly everything that is tried.
std::optional<classifier::TrunkModel> read(const std::string& text, files::Problems& problems) {
  auto table = files::parse_toml_text(text, "model.toml", problems);
  if (!table) return std::nullopt;
  table->erase("sha256");
  files::TomlReader reader(&*table, "", "model.toml", problems);
  return files::read_trunk_model(reader, problems);
}

void check_movement(const core::TrunkMovement& movement) {
  double sum = 0.0;
  for (const double probability : movement.probability) {
    promise(probability >= 0.0 && probability <= 1.0, "a probability is one");
    sum += probability;
  }
  promise(sum == 0.0 || std::abs(sum - 1.0) <= kSumTolerance, "probabilities sum to 1, or nothing could be computed");
  promise(sum != 0.0 || movement.trunk_class == core::TrunkClass::Rejected, "what cannot be computed is rejected");
  if (std::isnan(movement.trunk_deg)) return;
  promise(std::isfinite(movement.trunk_deg) && movement.trunk_deg >= -90.0 && movement.trunk_deg <= 90.0, "an angle is one");
  promise(movement.trunk_lo_deg <= movement.trunk_deg && movement.trunk_deg <= movement.trunk_hi_deg, "an angle lies in its interval");
}

void check_reaches(const classifier::TrunkModel& model) {
  constexpr std::array kSizes{0.0, 1e-300, 0.01, 1.0, 30.0, 1e30, 1e300, -1.0, HUGE_VAL, core::ReachFeatures::kUnknown};
  for (const double size : kSizes) {
    const core::ReachFeatures features{.p1_mm = size,
                                       .p2_mm = size / 2.0,
                                       .p3_mm = size * 2.0,
                                       .hold_mm = size,
                                       .rise_s = size,
                                       .rest_ratio = size,
                                       .ratio_change = -size,
                                       .twist = size,
                                       .smoothness = -size};
    check_movement(model.classify(features, 0));
    check_movement(model.best_guess(features, 0));
    const double arm_alone = model.arm_alone_probability(features);
    promise(std::isnan(arm_alone) || (arm_alone >= 0.0 && arm_alone <= 1.0), "the arm alone: a probability or nothing");
  }
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  files::Problems problems;
  const auto model = read(fuzz::text_of(bytes, size), problems);
  promise(model.has_value() == problems.empty(), "a model, or what is wrong with it");
  if (!model) return;
  const std::string text = files::trunk_model_text(*model);
  const auto again = read(text, problems);
  promise(again.has_value(), "what was written can be read");
  promise(files::trunk_model_text(*again) == text, "the model read is the one written");
  check_reaches(*again);
}

}  // namespace dts::fuzz::trunk_model

DTS_FUZZ_TARGET(trunk_model)
