// SPDX-License-Identifier: Apache-2.0
#include "record/losses.h"

#include <algorithm>
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

std::uint64_t count_of(const RecordedEvent& event, const std::string& key) {
  const auto found = std::ranges::find(event.values, key, &std::pair<std::string, EventValue>::first);
  const auto* count = found != event.values.end() ? std::get_if<std::int64_t>(&found->second) : nullptr;
  return count != nullptr && *count > 0 ? static_cast<std::uint64_t>(*count) : 0;
}

}  // namespace

void LossCounter::take(const RecordedEvent& event) {
  if (event.event == "loss") return losses_.add(GapReason::RingFull, {.gaps = 1, .scans = count_of(event, "scans")});
  if (event.event != "segment") return;
  const bool is_first = !has_begun_;
  has_begun_ = true;
  if (is_first) return;
  losses_.add(reason_of(text_of(event, "reason")), {.gaps = 1, .scans = count_of(event, "missing_scans")});
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
