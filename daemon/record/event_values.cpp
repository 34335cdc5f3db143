// SPDX-License-Identifier: Apache-2.0
#include "record/event_values.h"

#include <variant>

namespace dts::record {

const EventValue* EventValues::find(const std::string& key) const {
  const auto found = std::ranges::find(event_.values, key, &std::pair<std::string, EventValue>::first);
  return found != event_.values.end() ? &found->second : nullptr;
}

const EventValue* EventValues::needed(const std::string& key) {
  const EventValue* const value = find(key);
  if (value == nullptr) refuse(key);
  return value;
}

double EventValues::number(const std::string& key) {
  const EventValue* const value = needed(key);
  if (value == nullptr) return 0.0;
  if (const auto* number = std::get_if<double>(value)) return *number;
  if (const auto* number = std::get_if<std::int64_t>(value)) return static_cast<double>(*number);
  refuse(key);
  return 0.0;
}

std::int64_t EventValues::whole(const std::string& key, std::int64_t minimum, std::int64_t maximum) {
  const EventValue* const value = needed(key);
  const auto* const number = value == nullptr ? nullptr : std::get_if<std::int64_t>(value);
  if (number != nullptr && *number >= minimum && *number <= maximum) return *number;
  refuse(key);
  return minimum;
}

std::string EventValues::text(const std::string& key) {
  const EventValue* const value = needed(key);
  if (const auto* text = value == nullptr ? nullptr : std::get_if<std::string>(value)) return *text;
  refuse(key);
  return {};
}

std::string EventValues::json(const std::string& key) {
  const EventValue* const value = needed(key);
  if (const auto* nested = value == nullptr ? nullptr : std::get_if<JsonText>(value)) return nested->text;
  refuse(key);
  return {};
}

void EventValues::refuse(const std::string& key) {
  if (problem_.empty()) problem_ = key;
}

core::Status EventValues::check() const {
  if (problem_.empty()) return {};
  return core::fail(core::ErrorCode::DataDamaged, "event \"" + event_.event + "\" at segment " + std::to_string(event_.segment) +
                                                      ", scan " + std::to_string(event_.scan.value) + ": \"" + problem_ +
                                                      "\" is missing or impossible");
}

}  // namespace dts::record
