// SPDX-License-Identifier: Apache-2.0
#include "record/event.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <type_traits>

#include "record/damaged.h"
#include "record/xdf/number_text.h"

namespace dts::record {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxKeys = 64;
constexpr std::size_t kMaxBytes = 64U << 10U;
constexpr int kMaxDepth = 32;

/// The JSON library writes nested values by recursion, so that a few thousand brackets would overflow the stack.
bool is_too_deep(const std::string& text) noexcept {
  int depth = 0;
  bool is_in_text = false;
  bool is_escaped = false;
  for (const char character : text) {
    if (is_escaped) {
      is_escaped = false;
    } else if (is_in_text && character == '\\') {
      is_escaped = true;
    } else if (character == '"') {
      is_in_text = !is_in_text;
    } else if (!is_in_text && (character == '{' || character == '[')) {
      if (++depth > kMaxDepth) return true;
    } else if (!is_in_text && (character == '}' || character == ']')) {
      --depth;
    }
  }
  return false;
}

bool is_own_key(const std::string& key) noexcept { return key == "event" || key == "segment" || key == "scan"; }

EventValue value_of(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>();
  if (value.is_number_unsigned() && value.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max()) return value.get<double>();
  if (value.is_number_integer()) return value.get<std::int64_t>();
  if (value.is_number_float()) return value.get<double>();
  if (value.is_null()) return std::numeric_limits<double>::quiet_NaN();  // JSON has no other way to write an undefined number
  return JsonText{value.dump()};
}

void add(Json& object, const std::string& key, const EventValue& value) {
  if (const auto* nested = std::get_if<JsonText>(&value)) {
    object[key] = Json::parse(nested->text, nullptr, false);
    if (object[key].is_discarded()) object[key] = nullptr;
    return;
  }
  std::visit(
      [&](const auto& held) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(held)>, JsonText>) object[key] = held;
      },
      value);
}

/// Returns a count; 0 if the key is absent; nothing if the value is no count or above `largest`.
std::optional<std::uint64_t> count_of(const Json& object, const char* key, std::uint64_t largest) {
  const auto found = object.find(key);
  if (found == object.end()) return 0;
  if (!found->is_number_unsigned() || found->get<std::uint64_t>() > largest) return std::nullopt;
  return found->get<std::uint64_t>();
}

core::Result<RecordedEvent> event_of_object(const Json& object) {
  const auto named = object.find("event");
  if (named == object.end() || !named->is_string()) return core::fail(kDamaged, "an event without a name");
  const auto segment = count_of(object, "segment", std::numeric_limits<std::uint32_t>::max());
  const auto scan = count_of(object, "scan", std::numeric_limits<std::uint64_t>::max());
  if (!segment || !scan) return core::fail(kDamaged, "an event whose segment or scan is out of range");
  RecordedEvent event{.event = named->get<std::string>(), .segment = static_cast<std::uint32_t>(*segment), .scan = {*scan}};
  for (const auto& [key, value] : object.items())
    if (!is_own_key(key)) event.values.emplace_back(key, value_of(value));
  return event;
}

}  // namespace

std::string to_json(const RecordedEvent& event) {
  Json object = {{"event", event.event}, {"segment", event.segment}, {"scan", event.scan.value}};
  for (const auto& [key, value] : event.values)
    if (!is_own_key(key)) add(object, key, value);
  return object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

core::Result<RecordedEvent> event_of_json(const std::string& text) {
  if (text.size() > kMaxBytes) return core::fail(kDamaged, "an event of more than 64 KiB");
  if (is_too_deep(text)) return core::fail(kDamaged, "an event nested too deeply");
  const Json object = Json::parse(text, nullptr, false);
  if (!object.is_object()) return core::fail(kDamaged, "an event that is no JSON object");
  if (object.size() > kMaxKeys) return core::fail(kDamaged, "an event of more than 64 keys");
  return event_of_object(object);
}

std::string values_json(const RecordedEvent& event, const std::string& without) {
  Json object = Json::object();
  for (const auto& [key, value] : event.values)
    if (key != without) add(object, key, value);
  return object.empty() ? std::string() : object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string text_of(const EventValue& value) {
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  if (const auto* number = std::get_if<double>(&value)) return shortest_text(*number);
  if (const auto* number = std::get_if<std::int64_t>(&value)) return std::to_string(*number);
  if (const auto* nested = std::get_if<JsonText>(&value)) return nested->text;
  return std::get<bool>(value) ? "true" : "false";
}

std::string text_of(const RecordedEvent& event, const std::string& key) {
  const auto found = std::ranges::find(event.values, key, &std::pair<std::string, EventValue>::first);
  return found == event.values.end() ? std::string() : text_of(found->second);
}

}  // namespace dts::record
