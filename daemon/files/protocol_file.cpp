// SPDX-License-Identifier: Apache-2.0
#include "files/protocol_file.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "session/trial_run.h"

namespace dts::files {
namespace {

using session::Condition;
using session::Protocol;
using session::ProtocolField;
using session::TrialPlan;

constexpr std::size_t kMostProtocolBytes = std::size_t{256} << 10U;  // the header of every recording contains it
constexpr std::size_t kMostFiles = 1000;
constexpr std::size_t kLongestWord = 32;
constexpr std::size_t kLongestSentence = 200;
constexpr std::size_t kLongestTitle = 64;  // of a protocol, a condition, the label of a field
constexpr std::size_t kLongestUnit = 16;
constexpr std::array<std::string_view, 1> kLanguages = {"de"};  // besides English
constexpr std::size_t kMostEntries = 32;                        // fields, choices, conditions
constexpr std::size_t kMostLabels = 8;
constexpr std::int64_t kMostTrialsPerBlock = 200;
constexpr std::int64_t kMostBlocks = 50;
constexpr double kLongestSessionS = 7.0 * 86400.0;
constexpr double kLongestPhaseS = 3600.0;
constexpr double kMostPercent = 300.0;
constexpr double kLargestNumber = 1e6;

constexpr std::string_view kNameLetters = "abcdefghijklmnopqrstuvwxyz0123456789-";
constexpr std::string_view kFieldLetters = "abcdefghijklmnopqrstuvwxyz0123456789_";
/// Keys that events of dtsd 0.1 already use (record/old_event.h).
constexpr std::string_view kReservedLabels[] = {"event",     "segment", "scan",      "phase",  "trial", "attempt",
                                                "condition", "block",   "target_cm", "rest_s", "at_ns"};

bool is_word(const std::string& text, std::string_view letters) {
  return !text.empty() && text.size() <= kLongestWord && text.find_first_not_of(letters) == std::string::npos;
}

std::string word(TomlReader& reader, std::string_view key, std::string_view letters) {
  reader.require(key);
  std::string given = reader.text(key, "");
  const toml::node* node = reader.node(key);
  if (node != nullptr && node->is_string() && !is_word(given, letters)) {
    reader.report(key, std::string(key) + " must be 1 to 32 of the characters a-z, 0-9 and " + std::string(1, letters.back()));
  }
  return given;
}

std::string line(TomlReader& reader, std::string_view key, std::size_t most_bytes, const std::string& fallback = {}) {
  std::string given = reader.text(key, fallback);
  const bool has_control = std::ranges::any_of(given, [](char letter) { return static_cast<unsigned char>(letter) < ' '; });
  if (given.size() > most_bytes || has_control) {
    reader.report(key, std::string(key) + " must be one line of at most " + std::to_string(most_bytes) + " bytes");
  }
  return given;
}

/// Returns true the first time; else reports a problem at `key`.
bool is_first(std::set<std::string>& known, const std::string& given, TomlReader& reader, std::string_view key) {
  if (known.insert(given).second) return true;
  reader.report(key, "'" + given + "' is listed twice");
  return false;
}

std::vector<std::string> choices(TomlReader& reader) {
  std::vector<std::string> given = reader.texts("choices", {});
  std::set<std::string> known;
  if (given.size() < 2 || given.size() > kMostEntries) reader.report("choices", "choices must be 2 to 32 words");
  for (const std::string& one : given) {
    if (!is_word(one, kNameLetters)) reader.report("choices", "a choice must be 1 to 32 of the characters a-z, 0-9 and -");
    static_cast<void>(is_first(known, one, reader, "choices"));
  }
  return given;
}

/// Returns the texts in the languages besides English; `read` reads those of one language.
template <class Read>
std::vector<session::Translation> translations(TomlReader& reader, Read read) {
  std::vector<session::Translation> all;
  for (const std::string_view language : kLanguages) {
    if (reader.node(language) == nullptr) continue;
    TomlReader table = reader.table(language);
    session::Translation translation{.language = std::string(language)};
    read(table, translation);
    table.finish();
    all.push_back(std::move(translation));
  }
  return all;
}

void read_field_words(const ProtocolField& field, TomlReader& table, session::Translation& translation) {
  translation.label = line(table, "label", kLongestTitle);
  translation.unit = line(table, "unit", kLongestUnit);
  translation.help = line(table, "help", kLongestSentence);
  translation.choices = table.texts("choices", {});
  const bool is_short = std::ranges::all_of(translation.choices, [](const std::string& one) { return one.size() <= kLongestTitle; });
  if (!is_short || (!translation.choices.empty() && translation.choices.size() != field.choices.size())) {
    table.report("choices", "choices must be as many as the field has, in the same order");
  }
}

ProtocolField read_field(TomlReader& reader) {
  ProtocolField field;
  field.name = word(reader, "name", kFieldLetters);
  if (reader.node("sentence") != nullptr) {  // files of dtsd 0.1
    reader.report("sentence", "'sentence' of a field is now 'label', a short name; 'unit' and 'help' are separate");
  } else {
    reader.require("label");
  }
  field.label = line(reader, "label", kLongestTitle);
  field.unit = line(reader, "unit", kLongestUnit);
  field.help = line(reader, "help", kLongestSentence);
  field.is_required = reader.boolean("required", false);
  if (reader.node("choices") != nullptr) {  // `node` marks the key as known
    field.choices = choices(reader);
  } else if (!reader.has("minimum") && !reader.has("maximum")) {
    reader.report("", "[[field]] needs minimum and maximum, or choices");
  } else {
    reader.require("minimum");
    reader.require("maximum");
    field.minimum = reader.number("minimum", 0.0, -kLargestNumber, kLargestNumber);
    field.maximum = reader.number("maximum", field.minimum, -kLargestNumber, kLargestNumber);
    if (field.maximum < field.minimum) reader.report("maximum", "maximum is less than minimum");
  }
  field.translations =
      translations(reader, [&field](TomlReader& table, session::Translation& translation) { read_field_words(field, table, translation); });
  reader.finish();
  return field;
}

std::vector<std::pair<std::string, std::string>> read_labels(TomlReader reader) {
  std::vector<std::pair<std::string, std::string>> labels;
  for (const std::string& key : reader.remaining_keys()) {
    labels.emplace_back(key, reader.text(key, ""));
    if (std::ranges::find(kReservedLabels, key) != std::end(kReservedLabels)) reader.report(key, "label '" + key + "' is reserved");
    if (key == session::kFeedbackLabel) reader.report(key, "label 'feedback' is reserved: write feedback = true in the condition");
    if (!is_word(key, kFieldLetters)) reader.report(key, "a label's name must be 1 to 32 of the characters a-z, 0-9 and _");
    if (!is_word(labels.back().second, kNameLetters)) reader.report(key, "a label must be 1 to 32 of the characters a-z, 0-9 and -");
  }
  if (labels.size() > kMostLabels) reader.report("", "more than 8 labels");
  return labels;
}

/// Checks a condition in which the subject sees the own COP, and gives it its label.
void read_feedback(TomlReader& reader, Condition& condition) {
  const bool is_named_so = condition.name.ends_with(session::kFeedbackEnding);
  if (!reader.boolean("feedback", false)) {
    if (is_named_so) reader.report("name", "only a condition with feedback = true may have a name that ends with -feedback");
    return;
  }
  if (!is_named_so) reader.report("name", "the name of a condition with feedback must end with -feedback, so that its results stay apart");
  if (condition.is_maximum_reach || condition.target_percent) reader.report("feedback", "a condition with a target has no feedback");
  if (std::ranges::find(condition.labels, std::pair<std::string, std::string>("eyes", "closed")) != condition.labels.end()) {
    reader.report("feedback", "a condition with eyes closed has no feedback: the subject could not see it");
  }
  condition.labels.emplace_back(session::kFeedbackLabel, session::kCopFeedback);
}

Condition read_condition(TomlReader& reader) {
  Condition condition;
  condition.name = word(reader, "name", kNameLetters);
  condition.title = line(reader, "title", kLongestTitle, condition.name);
  if (reader.node("target_percent") != nullptr) condition.target_percent = reader.number("target_percent", 100.0, 1.0, kMostPercent);
  condition.is_maximum_reach = reader.boolean("maximum_reach", false);
  if (condition.is_maximum_reach && condition.target_percent) {
    reader.report("maximum_reach", "a target has maximum_reach or target_percent, not both");
  }
  condition.translations = translations(
      reader, [](TomlReader& table, session::Translation& translation) { translation.title = line(table, "title", kLongestTitle); });
  if (reader.node("labels") != nullptr) condition.labels = read_labels(reader.table("labels"));
  read_feedback(reader, condition);
  reader.finish();
  return condition;
}

double seconds(TomlReader& reader, std::string_view key, double fallback) { return reader.number(key, fallback, 0.0, kLongestPhaseS); }

void read_times(TomlReader& reader, TrialPlan& plan) {
  plan.cue_delay_min_s = seconds(reader, "cue_delay_min_s", 0.0);
  plan.cue_delay_max_s = seconds(reader, "cue_delay_max_s", plan.cue_delay_min_s);
  if (plan.cue_delay_max_s < plan.cue_delay_min_s) reader.report("cue_delay_max_s", "cue_delay_max_s is less than cue_delay_min_s");
  plan.settle_s = seconds(reader, "settle_s", 0.0);
  plan.duration_s = seconds(reader, "duration_s", 0.0);
  plan.rest_s = seconds(reader, "rest_s", 0.0);
  plan.block_rest_s = seconds(reader, "block_rest_s", plan.rest_s);
}

TrialPlan read_trials(TomlReader reader) {
  TrialPlan plan;
  std::set<std::string> known;
  for (TomlReader& entry : reader.tables("condition")) {
    plan.conditions.push_back(read_condition(entry));
    static_cast<void>(is_first(known, plan.conditions.back().name, entry, "name"));
  }
  if (plan.conditions.empty() || plan.conditions.size() > kMostEntries) {
    reader.report("", "[trials] needs 1 to 32 conditions: [[trials.condition]]");
  }
  const auto as_many = static_cast<std::int64_t>(std::clamp<std::size_t>(plan.conditions.size(), 1, kMostEntries));
  plan.trials_per_block = static_cast<std::uint32_t>(reader.integer("trials_per_block", as_many, 1, kMostTrialsPerBlock));
  plan.blocks = static_cast<std::uint32_t>(reader.integer("blocks", 1, 1, kMostBlocks));
  plan.order =
      reader.choice("order", {"as-listed", "randomised"}) == "randomised" ? session::TrialOrder::Randomised : session::TrialOrder::AsListed;
  plan.starts_by_itself = reader.boolean("starts_by_itself", false);
  read_times(reader, plan);
  reader.finish();
  return plan;
}

/// Checks that the protocol asks for the fields from which targets are computed; without them no session could start.
void check_targets(const Protocol& protocol, TomlReader& reader) {
  const auto asks_for = [&protocol](std::string_view name) {
    return std::ranges::any_of(protocol.fields, [&](const ProtocolField& field) { return field.name == name && field.choices.empty(); });
  };
  const auto is_maximum = [](const Condition& condition) { return condition.is_maximum_reach; };
  const auto is_percent = [](const Condition& condition) { return condition.target_percent.has_value(); };
  if (std::ranges::any_of(protocol.trials->conditions, is_maximum) && !asks_for("max_reach_cm")) {
    reader.report("trials", "a target at maximum_reach needs a [[field]] named max_reach_cm, in centimetres");
  }
  if (std::ranges::any_of(protocol.trials->conditions, is_percent) && !asks_for("arm_length_cm")) {
    reader.report("trials", "a target_percent needs a [[field]] named arm_length_cm, in centimetres");
  }
}

void check_feedback(const Protocol& protocol, TomlReader& reader) {
  if (protocol.rig_kind == "chair" && std::ranges::any_of(protocol.trials->conditions, session::has_feedback)) {
    reader.report("trials", "feedback needs a rig that measures the COP: rig_kind = \"floor\"");
  }
}

void read_fields(TomlReader& reader, Protocol& protocol) {
  std::set<std::string> known;
  for (TomlReader& entry : reader.tables("field")) {
    protocol.fields.push_back(read_field(entry));
    static_cast<void>(is_first(known, protocol.fields.back().name, entry, "name"));
  }
  if (protocol.fields.size() > kMostEntries) reader.report("field", "more than 32 fields");
}

void read_session_times(TomlReader& reader, Protocol& protocol) {
  protocol.settle_s = seconds(reader, "settle_s", 0.0);
  protocol.duration_s = reader.number("duration_s", 0.0, 0.0, kLongestSessionS);
  if (!protocol.trials) return;
  for (const std::string_view key : {"settle_s", "duration_s"}) {
    if (reader.has(key)) reader.report(key, std::string(key) + " is set for each trial in this protocol: write it below [trials]");
  }
}

std::optional<toml::table> parse_text(const std::string& text, const std::string& name, Problems& problems) {
  if (text.size() > kMostProtocolBytes) {
    problems.push_back({.file = name, .text = "is larger than 256 KiB: this is not a protocol file"});
    return std::nullopt;
  }
  return parse_toml_text(text, name, problems);
}

/// Returns the files of a folder, sorted by name, so that the order of problems is the same on every machine.
std::vector<std::string> toml_files(const std::string& folder, Problems& problems) {
  std::vector<std::string> files;
  std::error_code error;
  std::filesystem::directory_iterator entry(folder, error);
  for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error)) {
    if (entry->path().extension() == ".toml" && files.size() < kMostFiles) files.push_back(entry->path().string());
  }
  if (error && error != std::errc::no_such_file_or_directory) {
    problems.push_back({.file = folder, .text = "cannot be read: " + error.message()});
  }
  std::ranges::sort(files);
  return files;
}

}  // namespace

Protocol read_protocol_text(const std::string& text, const std::string& name, Problems& problems) {
  Protocol protocol;
  const auto table = parse_text(text, name, problems);
  if (!table) return protocol;
  TomlReader reader(&*table, "", name, problems);
  protocol.name = word(reader, "name", kNameLetters);
  protocol.title = line(reader, "title", kLongestTitle, protocol.name);
  protocol.sentence = line(reader, "sentence", kLongestSentence);
  protocol.translations = translations(reader, [](TomlReader& words, session::Translation& translation) {
    translation.title = line(words, "title", kLongestTitle);
    translation.sentence = line(words, "sentence", kLongestSentence);
  });
  if (reader.has("rig_kind")) protocol.rig_kind = reader.choice("rig_kind", {"floor", "chair"});
  read_fields(reader, protocol);
  if (reader.node("trials") != nullptr) {
    protocol.trials = read_trials(reader.table("trials"));
    check_targets(protocol, reader);
    check_feedback(protocol, reader);
  }
  read_session_times(reader, protocol);
  reader.finish();
  protocol.definition = text;
  return protocol;
}

Protocol read_protocol(const std::string& file, Problems& problems) {
  std::error_code unknown;
  std::ifstream stream;
  std::string text(kMostProtocolBytes + 1, '\0');
  if (std::filesystem::is_regular_file(file, unknown)) stream.open(file, std::ios::binary);  // opening a pipe would block
  if (stream.is_open()) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream.is_open() || stream.bad()) {
    problems.push_back({.file = file, .text = "cannot be read"});
    return {};
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return read_protocol_text(text, file, problems);
}

std::uint32_t planned_trials(const std::string& definition) {
  if (definition.empty()) return 0;
  Problems problems;
  const std::string name = "the recorded protocol";
  const auto table = parse_text(definition, name, problems);
  if (!table) return 0;
  TomlReader reader(&*table, "", name, problems);
  if (reader.node("trials") == nullptr) return 0;
  const TrialPlan plan = read_trials(reader.table("trials"));
  return problems.empty() ? session::planned_trials(plan) : 0;
}

std::vector<Protocol> read_protocols(const std::string& folder, Problems& problems) {
  std::vector<Protocol> protocols;
  std::vector<std::pair<std::string, std::string>> known;  // name, file
  for (const std::string& file : toml_files(folder, problems)) {
    const std::size_t known_problems = problems.size();
    Protocol protocol = read_protocol(file, problems);
    if (problems.size() > known_problems) continue;
    const auto twin = std::ranges::find_if(known, [&](const auto& one) { return one.first == protocol.name; });
    if (twin != known.end()) {
      problems.push_back({.file = file, .text = "name = \"" + protocol.name + "\" is taken by " + twin->second});
      continue;
    }
    known.emplace_back(protocol.name, file);
    protocols.push_back(std::move(protocol));
  }
  const Protocol built_in = session::free_protocol();
  if (std::ranges::none_of(protocols, [&](const Protocol& one) { return one.name == built_in.name; })) protocols.push_back(built_in);
  std::ranges::sort(protocols, {}, &Protocol::name);
  return protocols;
}

}  // namespace dts::files
