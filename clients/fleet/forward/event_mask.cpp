// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/event_mask.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

namespace dts::fleet::forward {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;

/// Texts that programs make, or that a protocol defines. What a person types (labels, markers, reasons of an abort) is not here, nor are
/// the details of a result, which repeat fields of the protocol.
constexpr std::array<std::string_view, 39> kSentTexts{"dts.v1.Trigger.channel",
                                                      "dts.v1.DeviceChange.uri",
                                                      "dts.v1.SessionChange.session_id",
                                                      "dts.v1.SessionChange.protocol",
                                                      "dts.v1.SessionChange.subject",
                                                      "dts.v1.TrialChange.session_id",
                                                      "dts.v1.TrialChange.condition",
                                                      "dts.v1.TrialChange.labels",
                                                      "dts.v1.TrialResult.session_id",
                                                      "dts.v1.TrialResult.condition",
                                                      "dts.v1.Sway.session_id",
                                                      "dts.v1.Sway.condition",
                                                      "dts.v1.Sway.labels",
                                                      "dts.v1.Sway.profile",
                                                      "dts.v1.Sway.software",
                                                      "dts.v1.Sway.problem",
                                                      "dts.v1.SwayMeasure.symbol",
                                                      "dts.v1.SwayMeasure.unit",
                                                      "dts.v1.SessionResult.name",
                                                      "dts.v1.SessionResult.unit",
                                                      "dts.v1.StatusSnapshot.version",
                                                      "dts.v1.StatusSnapshot.boot_id",
                                                      "dts.v1.RigInfo.name",
                                                      "dts.v1.RigInfo.kind",
                                                      "dts.v1.RigInfo.stages",
                                                      "dts.v1.RigInfo.published",
                                                      "dts.v1.RigInfo.calibration",
                                                      "dts.v1.SensorInfo.label",
                                                      "dts.v1.SensorInfo.channel",
                                                      "dts.v1.SensorInfo.curve",
                                                      "dts.v1.StreamFormat.name",
                                                      "dts.v1.Channel.name",
                                                      "dts.v1.Channel.unit",
                                                      "dts.v1.SessionInfo.session_id",
                                                      "dts.v1.SessionInfo.rig",
                                                      "dts.v1.SessionInfo.protocol",
                                                      "dts.v1.SessionInfo.subject",
                                                      "dts.v1.TrialStatus.condition",
                                                      "dts.v1.TrialStatus.next_condition"};
constexpr std::array<std::string_view, 3> kLabelTexts{"dts.v1.Marker.text", "dts.v1.SessionChange.label", "dts.v1.SessionInfo.label"};
/// Keys of the events of dtsd 0.1 whose texts are made by programs.
constexpr std::array<std::string_view, 13> kOldKeys{"event",   "condition", "phase", "state",   "edge",     "reason", "step",
                                                    "channel", "unit",      "name",  "profile", "software", "problem"};
constexpr std::size_t kLongestWord = 64;
constexpr std::size_t kDeepest = 16;

bool contains(const auto& list, std::string_view word) { return std::ranges::find(list, word) != list.end(); }

bool is_sent(const FieldDescriptor& field, const wire::SendRules& rules) {
  return contains(kSentTexts, field.full_name()) || (rules.labels && contains(kLabelTexts, field.full_name()));
}

/// Returns true for the text of a number or of an enumerator: "1250", "NaN", "SESSION_STATE_IDLE".
bool is_word(std::string_view text) {
  return text.size() <= kLongestWord && std::ranges::all_of(text, [](char letter) {
           return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9') ||
                  letter == '_' || letter == '+' || letter == '-' || letter == '.';
         });
}

/// Walks through valid JSON and masks texts in place. Follows the message types, so that each text is judged by its field.
class JsonMask {
 public:
  JsonMask(std::span<char> json, const wire::SendRules& rules) : json_(json), rules_(rules) {}

  /// Returns false if the text is nested more deeply than an event; it may then be masked in parts only.
  [[nodiscard]] bool run() {
    const Place event{.type = v1::Event::descriptor()};
    return mask_value(event, 0) && at_ == json_.size();
  }

 private:
  /// What the value at hand is: a message of a type, a field's value, or neither.
  struct Place {
    const Descriptor* type = nullptr;
    const FieldDescriptor* field = nullptr;
    bool is_sent = false;
  };

  void skip_blanks() {
    while (at_ < json_.size() && std::string_view(" \t\r\n").find(json_[at_]) != std::string_view::npos) ++at_;
  }
  /// Returns the characters between the quotes; `at_` is at the first quote, and then after the last.
  std::span<char> text() {
    const std::size_t begin = ++at_;
    while (at_ < json_.size() && json_[at_] != '"') at_ += json_[at_] == '\\' ? 2 : 1;
    const std::size_t end = std::min(at_, json_.size());
    at_ = std::min(end + 1, json_.size());
    return json_.subspan(begin, end - begin);
  }
  static std::string_view view(std::span<char> text) { return {text.data(), text.size()}; }

  [[nodiscard]] Place place_of(const Place& parent, std::string_view key, std::size_t depth) const {
    if (parent.type == nullptr) return {.field = parent.field, .is_sent = parent.is_sent};  // an entry of a map
    const FieldDescriptor* field = parent.type->FindFieldByName({key.data(), key.size()});
    if (field == nullptr) return {.is_sent = depth == 1 && contains(kOldKeys, key)};
    if (field->is_map()) return {.field = field, .is_sent = is_sent(*field, rules_)};
    if (field->message_type() != nullptr) return {.type = field->message_type()};
    return {.field = field, .is_sent = is_sent(*field, rules_)};
  }
  [[nodiscard]] static bool may_leave(const Place& place, std::string_view text) {
    if (place.is_sent) return true;
    const bool is_free = place.field == nullptr || place.field->is_map() || place.field->cpp_type() == FieldDescriptor::CPPTYPE_STRING;
    return !is_free && is_word(text);
  }

  bool mask_object(const Place& place, std::size_t depth) {
    for (++at_; at_ < json_.size();) {
      skip_blanks();
      if (at_ < json_.size() && json_[at_] == '}') return ++at_, true;
      if (at_ < json_.size() && json_[at_] == ',') {
        ++at_;
        continue;
      }
      if (at_ >= json_.size() || json_[at_] != '"') return false;
      const std::span<char> key = text();
      const Place child = place_of(place, view(key), depth);
      // The name of a field is ours, and so are the old keys. Any other key may be anything.
      const bool is_known = place.type != nullptr ? (child.type != nullptr || child.field != nullptr || child.is_sent) : child.is_sent;
      if (!is_known) std::ranges::fill(key, kMask);
      skip_blanks();
      if (at_ >= json_.size() || json_[at_] != ':') return false;
      ++at_;
      if (!mask_value(child, depth)) return false;
    }
    return false;
  }
  bool mask_array(const Place& place, std::size_t depth) {
    for (++at_; at_ < json_.size();) {
      skip_blanks();
      if (at_ < json_.size() && json_[at_] == ']') return ++at_, true;
      if (at_ < json_.size() && json_[at_] == ',') {
        ++at_;
        continue;
      }
      if (!mask_value(place, depth)) return false;
    }
    return false;
  }
  bool mask_value(const Place& place, std::size_t depth) {
    skip_blanks();
    if (depth >= kDeepest || at_ >= json_.size()) return false;
    if (json_[at_] == '{') return mask_object(place, depth + 1);
    if (json_[at_] == '[') return mask_array(place, depth + 1);
    if (json_[at_] == '"') {
      const std::span<char> value = text();
      if (!may_leave(place, view(value))) std::ranges::fill(value, kMask);
      return true;
    }
    const std::size_t begin = at_;  // a number, true, false, null
    while (at_ < json_.size() && std::string_view(",}] \t\r\n").find(json_[at_]) == std::string_view::npos) ++at_;
    return at_ > begin;
  }

  std::span<char> json_;
  const wire::SendRules& rules_;
  std::size_t at_ = 0;
};

void mask_message(google::protobuf::Message& message, const wire::SendRules& rules) {
  const auto& reflection = *message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection.ListFields(message, &fields);
  reflection.MutableUnknownFields(&message)->Clear();
  for (const FieldDescriptor* field : fields) {
    if (field->is_map() || field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
      if (!is_sent(*field, rules)) reflection.ClearField(&message, field);
    } else if (field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      const int count = field->is_repeated() ? reflection.FieldSize(message, field) : 1;
      for (int index = 0; index < count; ++index) {
        mask_message(
            field->is_repeated() ? *reflection.MutableRepeatedMessage(&message, field, index) : *reflection.MutableMessage(&message, field),
            rules);
      }
    }
  }
}

}  // namespace

void mask_event(std::span<char> json, const wire::SendRules& rules) {
  const std::string_view text(json.data(), json.size());
  const bool is_object = !text.empty() && text.front() == '{' && nlohmann::json::accept(text);
  if (!is_object || !JsonMask(json, rules).run()) std::ranges::fill(json, kMask);
}

void mask_event(v1::Event& event, const wire::SendRules& rules) { mask_message(event, rules); }
void mask_status(v1::StatusSnapshot& status, const wire::SendRules& rules) { mask_message(status, rules); }

}  // namespace dts::fleet::forward
