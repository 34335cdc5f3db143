// SPDX-License-Identifier: Apache-2.0
#include "record/old_event.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <nlohmann/json.hpp>
#include <string_view>

#include "dts/wire/event_json.h"

namespace dts::record {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxKeys = 64;
constexpr int kMaxDepth = 32;
/// JSON keys that can hold the main text of an event. The first one that the event has is used.
constexpr std::array<std::string_view, 5> kMainKeys{"text", "phase", "state", "edge", "reason"};
/// Keys of a trial; every other key with a text is a label.
constexpr std::array<std::string_view, 7> kTrialKeys{"phase", "trial", "attempt", "block", "condition", "target_cm", "rest_s"};

/// The JSON library writes nested values by recursion, so that a few thousand brackets would overflow the stack.
bool is_too_deep(std::string_view text) noexcept {
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

bool is_own_key(std::string_view key) noexcept { return key == "event" || key == "segment" || key == "scan"; }

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// Returns the value of a key; null if it is absent.
Json value_of(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? Json(nullptr) : *found;
}

/// Returns a number without the sign of zero, which the present form does not keep; anything else as it is.
Json unsigned_zero(const Json& value) { return value.is_number_float() ? Json(value.get<double>() + 0.0) : value; }

/// Copies the values of the keys that the event has.
void copy_keys(const Json& old, std::initializer_list<const char*> keys, Json& out) {
  for (const char* key : keys) {
    if (const auto found = old.find(key); found != old.end()) out[key] = unsigned_zero(*found);
  }
}

/// "p1" of ReachStep was "REACH_STEP_P1" with this prefix. Returns the number of the enumerator; 0 if the word is
/// unknown.
int enumerator(const char* prefix, const Json& word, const google::protobuf::EnumDescriptor& type) {
  std::string name = word.is_string() ? word.get<std::string>() : std::string("?");
  std::ranges::transform(name, name.begin(), [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  const auto* value = type.FindValueByName(prefix + name);
  return value == nullptr ? 0 : value->number();
}

/// Adds the difference of two numbers if both are known.
void add_difference(const Json& minuend, const Json& subtrahend, const char* key, Json& out) {
  if (minuend.is_number() && subtrahend.is_number()) out[key] = minuend.get<double>() - subtrahend.get<double>();
}

Json reach_of(const Json& old) {
  Json out = {{"step", enumerator("REACH_STEP_", value_of(old, "step"), *v1::ReachStep_descriptor())}};
  copy_keys(old, {"number", "hold_mm", "rise_s", "rest_ratio", "ratio_change", "twist", "smoothness", "flags", "resumed"}, out);
  for (const char* point : {"p1", "p2", "p3"}) {
    const std::string name(point);
    if (const Json mm = value_of(old, (name + "_mm").c_str()); !mm.is_null()) {
      out[name] = {{"scan", value_of(old, (name + "_scan").c_str())}, {"value_mm", unsigned_zero(mm)}};
    }
  }
  add_difference(value_of(old, "p1_mm"), value_of(old, "p2_mm"), "d1_mm", out);
  add_difference(value_of(old, "p3_mm"), value_of(old, "p1_mm"), "d2_mm", out);
  return out;
}

Json movement_of(const Json& old) {
  Json out = {{"trunk_class", value_of(old, "class")}};
  copy_keys(old, {"number", "trunk_deg", "trunk_lo_deg", "trunk_hi_deg", "reasons"}, out);
  if (old.contains("p_1")) out["probability"] = {value_of(old, "p_1"), value_of(old, "p_2"), value_of(old, "p_3")};
  return out;
}

/// Of the reach, dtsd 0.1 recorded only number and flags.
Json result_of(const Json& old) {
  Json out = Json::object();
  copy_keys(old, {"trial", "attempt", "condition", "target_cm", "expected_class", "is_at_end"}, out);
  if (old.contains("number")) copy_keys(old, {"number", "flags"}, out["reach"] = Json::object());
  if (old.contains("class")) out["movement"] = movement_of(old);
  return out;
}

Json trial_of(const Json& old) {
  Json out = {{"step", enumerator("TRIAL_EVENT_KIND_", value_of(old, "phase"), *v1::TrialEventKind_descriptor())}};
  copy_keys(old, {"trial", "attempt", "block", "condition", "target_cm", "rest_s"}, out);
  for (const auto& [key, value] : old.items()) {
    const bool is_label = value.is_string() && !is_own_key(key) && std::ranges::find(kTrialKeys, key) == kTrialKeys.end();
    if (is_label) out["labels"][key] = value;
  }
  return out;
}

Json sway_of(const Json& old) {
  Json out = Json::object();
  copy_keys(old,
            {"trial", "attempt", "condition", "labels", "first_segment", "first_scan", "end_segment", "end_scan", "profile", "rate_hz",
             "samples", "duration_s", "flags", "missing", "interpolated", "is_valid", "software", "problem"},
            out);
  const Json measures = value_of(old, "measures");
  if (!measures.is_object()) return out;
  for (const auto& [symbol, entry] : measures.items()) {
    if (!entry.is_object() || !value_of(entry, "value").is_number()) return Json::array();  // invalid: absent would read as 0
    Json measure = {{"symbol", symbol}};
    copy_keys(entry, {"value", "unit"}, measure);
    out["measures"].push_back(std::move(measure));
  }
  return out;
}

Json session_of(const Json& old) {
  Json out = Json::object();
  copy_keys(old, {"message"}, out);
  if (value_of(old, "state") == "aborted") {
    out["is_aborted"] = true;
  } else {
    out["state"] = enumerator("SESSION_STATE_", value_of(old, "state"), *v1::SessionState_descriptor());
  }
  return out;
}

Json copied(const Json& old, std::initializer_list<const char*> keys) {
  Json out = Json::object();
  copy_keys(old, keys, out);
  return out;
}

/// Returns the event in the present form; null if its word is unknown.
Json renewed(const Json& old) {
  Json out = Json::object();
  copy_keys(old, {"segment", "scan"}, out);
  const Json word = value_of(old, "event");
  if (word == "reach") {
    out["reach"] = reach_of(old);
  } else if (word == "class") {
    out["movement"] = movement_of(old);
  } else if (word == "result") {
    out["trial_result"] = result_of(old);
  } else if (word == "trial") {
    out["trial"] = trial_of(old);
  } else if (word == "sway") {
    out["sway"] = sway_of(old);
  } else if (word == "segment") {
    copy_keys(old, {"host_time_ns"}, out);
    out["segment_start"] = copied(old, {"missing_scans", "is_exact"});
    if (old.contains("reason"))
      out["segment_start"]["reason"] = enumerator("GAP_REASON_", value_of(old, "reason"), *v1::GapReason_descriptor());
  } else if (word == "session") {
    out["session"] = session_of(old);
  } else if (word == "device") {
    out["device"] = copied(old, {"message"});
    out["device"]["state"] = enumerator("DEVICE_STATE_", value_of(old, "state"), *v1::DeviceState_descriptor());
  } else if (word == "trigger") {
    out["trigger"] = copied(old, {"channel"});
    out["trigger"]["edge"] = enumerator("TRIGGER_EDGE_", value_of(old, "edge"), *v1::TriggerEdge_descriptor());
  } else if (word == "marker") {
    out["marker"] = copied(old, {"text"});
  } else if (word == "loss") {
    out["loss"] = copied(old, {"scans"});
  } else if (word == "figure" && value_of(old, "value").is_number()) {  // absent would read as 0
    out["figure"] = copied(old, {"name", "value", "unit", "details"});
  } else {
    return nullptr;
  }
  return out;
}

std::string text_of(const Json& value) { return value.is_string() ? value.get<std::string>() : dumped(value); }

}  // namespace

std::optional<v1::Event> old_event_of(const std::string& text) {
  if (text.size() > wire::kLongestEventJson || is_too_deep(text)) return std::nullopt;
  const Json old = Json::parse(text, nullptr, false);
  if (!old.is_object() || old.size() > kMaxKeys) return std::nullopt;
  const Json event = renewed(old);
  return event.is_null() ? std::nullopt : wire::event_of_json(dumped(event));
}

EventCells old_cells_of(const std::string& text) {
  Json rest = Json::parse(text, nullptr, false);
  if (!rest.is_object()) return {};
  EventCells cells{.kind = text_of(value_of(rest, "event")), .text = {}};
  if (rest.contains("condition")) cells.condition = text_of(rest["condition"]);
  for (const char* key : {"event", "segment", "scan"}) rest.erase(key);
  const auto main = std::ranges::find_if(kMainKeys, [&rest](std::string_view key) { return rest.contains(std::string(key)); });
  if (main != kMainKeys.end()) {
    cells.text = text_of(rest[std::string(*main)]);
    rest.erase(std::string(*main));
  }
  if (!rest.empty()) cells.details = dumped(rest);
  return cells;
}

std::optional<v1::Event> event_of_text(const std::string& text) {
  auto event = wire::event_of_json(text);
  return event ? event : old_event_of(text);
}

}  // namespace dts::record
