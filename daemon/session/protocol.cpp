// SPDX-License-Identifier: Apache-2.0
#include "session/protocol.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "core/join.h"
#include "core/number_text.h"
#include "core/suggest.h"

namespace dts::session {
namespace {

using Fields = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kArmLength = "arm_length_cm";
constexpr const char* kMaximumReach = "max_reach_cm";
/// Arm and reach are measured to 0.5 cm (thesis Table 6.1), so a smaller excess does not reject a target.
constexpr double kReachToleranceCm = 0.5;

tl::unexpected<core::Error> wrong(std::string what, std::string hint) {
  return core::fail(core::ErrorCode::InvalidArgument, std::move(what), std::move(hint));
}

std::optional<double> number_of(const std::string& text) {
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);  // independent of the locale
  if (error != std::errc() || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Errors of fields, each with the field's name.
using FieldErrors = std::vector<std::pair<std::string, core::Error>>;

/// Combines all errors into one, so that the user sees them at once. If there are several, each hint names its field.
core::Status all_of(const FieldErrors& errors) {
  if (errors.empty()) return {};
  if (errors.size() == 1) return tl::make_unexpected(errors.front().second);
  core::Error all{.code = errors.front().second.code, .what = {}, .hint = {}};
  for (const auto& [name, error] : errors) {
    all.what += (all.what.empty() ? "" : "; ") + error.what;
    all.hint += (all.hint.empty() ? "" : "; ") + name + (name.empty() ? "" : ": ") + error.hint;
  }
  return tl::make_unexpected(all);
}

/// Returns whether the word may be repeated in a message: it is written like the name of a field, and unlike a person's name.
bool looks_like_field(const std::string& word) {
  constexpr std::size_t kLongest = 32;
  return !word.empty() && word.size() <= kLongest && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos;
}

core::Status check_known(const Protocol& protocol, const Fields& fields) {
  std::vector<std::string> names;
  for (const ProtocolField& field : protocol.fields) names.push_back(field.name);
  for (std::size_t index = 0; index < fields.size(); ++index) {
    const std::string& given = fields[index].first;
    if (std::ranges::find(names, given) != names.end()) continue;
    const std::string place = std::to_string(index + 1) + " of " + std::to_string(fields.size());
    return wrong(looks_like_field(given) ? "protocol '" + protocol.name + "' has no field '" + given + "'"
                                         : "field " + place + " is not a field of protocol '" + protocol.name + "'",
                 names.empty() ? "remove it: this protocol has no fields" : core::known_words_hint(given, names));
  }
  return {};
}

core::Status check_value(const ProtocolField& field, const std::string& value) {
  if (!field.choices.empty()) {
    if (std::ranges::find(field.choices, value) != field.choices.end()) return {};
    return wrong("field '" + field.name + "' is not one of its choices", "choices: " + core::join(field.choices));
  }
  const auto number = number_of(value);
  if (!number) return wrong("field '" + field.name + "' is not a number", "write it as 65.5, without a unit");
  if (*number >= field.minimum && *number <= field.maximum) return {};
  return wrong("field '" + field.name + "' is out of range",
               "allowed: " + core::number_text(field.minimum) + " .. " + core::number_text(field.maximum));
}

/// Returns the options for all required fields that are missing: "--field sex=female|male --field age_years=1..120".
std::string missing(const Protocol& protocol, const Fields& fields) {
  std::string options;
  for (const ProtocolField& field : protocol.fields) {
    const bool is_given = std::ranges::any_of(fields, [&field](const auto& given) { return given.first == field.name; });
    if (is_given || !field.is_required) continue;
    std::string allowed = core::join(field.choices, "|");
    if (field.choices.empty()) allowed = core::number_text(field.minimum) + ".." + core::number_text(field.maximum);
    options += (options.empty() ? "" : " ") + ("--field " + field.name) + "=" + allowed;
  }
  return options;
}

core::Status check_field(const ProtocolField& field, const Fields& fields) {
  const auto is_named = [&field](const auto& given) { return given.first == field.name; };
  const auto found = std::ranges::find_if(fields, is_named);
  if (found == fields.end()) return {};  // `check_fields` reports all missing fields together
  if (std::ranges::count_if(fields, is_named) > 1) return wrong("field '" + field.name + "' is given twice", "give it once");
  return check_value(field, found->second);
}

core::Status check_target(const Condition& condition, const Fields& fields) {
  const auto needs = [&](const char* field) {
    return wrong("field '" + std::string(field) + "' is missing: target '" + condition.name + "' needs it", "measure it and add it, in cm");
  };
  const auto maximum_reach_cm = field_number(fields, kMaximumReach);
  if (condition.is_maximum_reach) {
    if (!maximum_reach_cm) return needs(kMaximumReach);
    return {};
  }
  if (!condition.target_percent) return {};
  const auto distance_cm = target_cm(condition, fields);
  if (!distance_cm) return needs(kArmLength);
  if (!maximum_reach_cm || *distance_cm <= *maximum_reach_cm + kReachToleranceCm) return {};
  return wrong("target '" + condition.name + "' is at " + core::number_text(*distance_cm) + " cm, beyond the subject's maximum reach of " +
                   core::number_text(*maximum_reach_cm) + " cm",
               "use a protocol without this target: copy the file and remove the condition");
}

}  // namespace

Protocol free_protocol() {
  Protocol protocol;
  protocol.title = "Free recording";
  protocol.sentence = "Records until it is stopped";
  protocol.translations = {
      {.language = "de", .title = "Freie Aufzeichnung", .sentence = "Zeichnet auf, bis die Untersuchung beendet wird"}};
  protocol.definition = "name = \"" + protocol.name + "\"\ntitle = \"" + protocol.title + "\"\nsentence = \"" + protocol.sentence + "\"\n" +
                        "de = { title = \"" + protocol.translations.front().title + "\", sentence = \"" +
                        protocol.translations.front().sentence + "\" }\n";
  return protocol;
}

core::Status check_fields(const Protocol& protocol, const Fields& fields) {
  FieldErrors errors;
  const auto collect = [&errors](const std::string& name, const core::Status& status) {
    if (!status) errors.emplace_back(name, status.error());
  };
  collect({}, check_known(protocol, fields));
  for (const ProtocolField& field : protocol.fields) collect(field.name, check_field(field, fields));
  if (const std::string options = missing(protocol, fields); !options.empty()) {
    collect({}, wrong("protocol '" + protocol.name + "' needs more fields about the subject", "add " + options));
  }
  if (!errors.empty()) return all_of(errors);
  if (!protocol.trials) return {};
  for (const Condition& condition : protocol.trials->conditions) {
    DTS_TRY(check_target(condition, fields));
  }
  return {};
}

bool has_feedback(const Condition& condition) {
  return std::ranges::find(condition.labels, kFeedbackLabel, &std::pair<std::string, std::string>::first) != condition.labels.end();
}

std::optional<double> field_number(const Fields& fields, const std::string& name) {
  const auto found = std::ranges::find_if(fields, [&name](const auto& given) { return given.first == name; });
  return found == fields.end() ? std::nullopt : number_of(found->second);
}

std::optional<double> target_cm(const Condition& condition, const Fields& fields) {
  if (condition.is_maximum_reach) return field_number(fields, kMaximumReach);
  const auto arm_length_cm = field_number(fields, kArmLength);
  if (!condition.target_percent || !arm_length_cm) return std::nullopt;
  return *condition.target_percent * *arm_length_cm / 100.0;
}

std::optional<double> target_percent(const Condition& condition, const Fields& fields) {
  if (condition.target_percent) return condition.target_percent;
  const auto distance_cm = target_cm(condition, fields);
  const auto arm_length_cm = field_number(fields, kArmLength);
  if (!distance_cm || !arm_length_cm || *arm_length_cm <= 0.0) return std::nullopt;
  return *distance_cm / *arm_length_cm * 100.0;
}

}  // namespace dts::session
