// SPDX-License-Identifier: Apache-2.0
#include "record/losses.h"

#include <nlohmann/json.hpp>
#include <string_view>

namespace dts::record {
namespace {

using core::GapReason;

/// Returns None for an unknown word.
GapReason reason_of(std::string_view word) {
  for (std::size_t index = 0; index < core::kGapReasons; ++index) {
    if (core::name(static_cast<GapReason>(index)) == word) return static_cast<GapReason>(index);
  }
  return GapReason::None;
}

/// Returns None for a number that this version does not know.
GapReason reason_of(v1::GapReason number) {
  return number >= 0 && static_cast<std::size_t>(number) < core::kGapReasons ? static_cast<GapReason>(number) : GapReason::None;
}

}  // namespace

void LossCounter::add(const v1::Event& event) {
  if (event.has_loss()) return losses_.add(GapReason::RingFull, {.gaps = 1, .scans = event.loss().scans()});
  if (!event.has_segment_start()) return;
  const bool is_first = !has_begun_;
  has_begun_ = true;
  if (is_first) return;
  losses_.add(reason_of(event.segment_start().reason()), {.gaps = 1, .scans = event.segment_start().missing_scans()});
}

std::string to_json(const core::Losses& losses) {
  nlohmann::json object = nlohmann::json::object();
  for (std::size_t index = 0; index < core::kGapReasons; ++index) {
    const auto reason = static_cast<GapReason>(index);
    const core::LossCount& count = losses.of(reason);
    if (count != core::LossCount{}) object[std::string(core::name(reason))] = {{"gaps", count.gaps}, {"scans", count.scans}};
  }
  return object.dump();
}

std::optional<core::Losses> losses_of_json(const std::string& text) {
  const nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  if (!object.is_object()) return std::nullopt;
  core::Losses losses;
  for (const auto& [word, count] : object.items()) {
    const auto is_count = [&count](const char* key) { return count.contains(key) && count[key].is_number_unsigned(); };
    if (!count.is_object() || !is_count("gaps") || !is_count("scans")) return std::nullopt;
    losses.add(reason_of(word), {.gaps = count["gaps"].get<std::uint64_t>(), .scans = count["scans"].get<std::uint64_t>()});
  }
  return losses;
}

}  // namespace dts::record
