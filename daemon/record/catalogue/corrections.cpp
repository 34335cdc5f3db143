// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/corrections.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <ranges>

#include "core/utf8.h"
#include "record/replace_file.h"

namespace dts::record {
namespace {

using core::ErrorCode;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kLongestCorrections = 16U << 20U;
constexpr std::array kCorrectedFields{CorrectedField::Subject, CorrectedField::Label,   CorrectedField::Notes,
                                      CorrectedField::Outcome, CorrectedField::Deleted, CorrectedField::Marker};

tl::unexpected<core::Error> damaged_corrections(const std::string& file, const std::string& why) {
  return core::fail(ErrorCode::DataDamaged, "the corrections in '" + file + "' cannot be read: " + why,
                    "restore the file from a backup; the recording beside it is not affected");
}

/// Reads members of one object. Keeps the first problem.
class CorrectionReader {
 public:
  explicit CorrectionReader(const Json& object) : object_(object) {}

  [[nodiscard]] std::string text(const char* key) {
    const auto found = object_.find(key);
    const bool is_good = found != object_.end() && found->is_string() && is_text(found->get_ref<const std::string&>());
    if (!is_good) return note(key), "";
    return found->get<std::string>();
  }
  [[nodiscard]] std::uint32_t count(const char* key) { return static_cast<std::uint32_t>(integer(key, 0, 1'000'000)); }
  [[nodiscard]] std::int64_t integer(const char* key, std::int64_t least, std::int64_t most) {
    const auto found = object_.find(key);
    if (found == object_.end() || !found->is_number_integer()) return note(key), least;
    const auto value = found->get<std::int64_t>();
    if (value < least || value > most) return note(key), least;
    return value;
  }
  void note(const std::string& key) {
    if (problem_.empty()) problem_ = "'" + key + "' is missing or not valid";
  }
  [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

 private:
  /// As in a request: one line without control characters.
  static bool is_text(const std::string& text) { return text.size() <= kLongestCorrectionText && core::printable(text) == text; }

  const Json& object_;
  std::string problem_;
};

core::Result<Correction> read_correction(const Json& object, const std::string& file, std::uint32_t number) {
  if (!object.is_object()) return damaged_corrections(file, "a correction is not an object");
  CorrectionReader reader(object);
  Correction read{.number = number,
                  .utc_ns = reader.integer("utc_ns", 0, std::numeric_limits<std::int64_t>::max()),
                  .who = reader.text("who"),
                  .old_value = reader.text("old_value"),
                  .new_value = reader.text("new_value"),
                  .reason = reader.text("reason")};
  const std::string field = reader.text("field");
  const auto* const known = std::ranges::find(kCorrectedFields, field, [](CorrectedField one) { return name(one); });
  if (known == kCorrectedFields.end()) {
    reader.note("field");
  } else {
    read.field = *known;
  }
  if (read.field == CorrectedField::Marker) {
    read.part = reader.count("part");
    read.marker = reader.count("marker");
  }
  if (read.field == CorrectedField::Outcome) {
    read.part = reader.count("part");
    read.trial = reader.count("trial");
    read.attempt = reader.count("attempt");
    if (std::ranges::find(kTrialOutcomes, read.new_value) == kTrialOutcomes.end()) reader.note("new_value");
  }
  if (read.field == CorrectedField::Subject) {
    const bool is_subject = read.new_value.size() <= kLongestSubject && is_id(read.new_value);
    if (!is_subject && read.new_value != kErasedText) reader.note("new_value");
  }
  if (!reader.problem().empty()) return damaged_corrections(file, "correction " + std::to_string(number) + ": " + reader.problem());
  return read;
}

Json json_of(const Correction& correction) {
  Json json{{"utc_ns", correction.utc_ns}, {"who", correction.who}, {"field", name(correction.field)}};
  if (correction.field == CorrectedField::Outcome) {
    json["part"] = correction.part;
    json["trial"] = correction.trial;
    json["attempt"] = correction.attempt;
  }
  if (correction.field == CorrectedField::Marker) {
    json["part"] = correction.part;
    json["marker"] = correction.marker;
  }
  json["old_value"] = correction.old_value;
  json["new_value"] = correction.new_value;
  json["reason"] = correction.reason;
  return json;
}

}  // namespace

std::string_view name(CorrectedField field) noexcept {
  switch (field) {
    case CorrectedField::Subject: return "subject";
    case CorrectedField::Label: return "label";
    case CorrectedField::Notes: return "notes";
    case CorrectedField::Outcome: return "outcome";
    case CorrectedField::Deleted: return "deleted";
    case CorrectedField::Marker: return "marker";
  }
  return "unknown";
}

bool is_text(CorrectedField field) noexcept {
  return field == CorrectedField::Label || field == CorrectedField::Notes || field == CorrectedField::Marker;
}

const std::string* Corrections::value(CorrectedField field) const {
  const auto newest = std::ranges::find(all.rbegin(), all.rend(), field, &Correction::field);
  return newest == all.rend() ? nullptr : &newest->new_value;
}

const std::string* Corrections::outcome(std::uint32_t part, std::uint32_t trial, std::uint32_t attempt) const {
  const auto newest = std::find_if(all.rbegin(), all.rend(), [&](const Correction& one) {
    return one.field == CorrectedField::Outcome && one.part == part && one.trial == trial && one.attempt == attempt;
  });
  return newest == all.rend() ? nullptr : &newest->new_value;
}

const std::string* Corrections::marker(std::uint32_t part, std::uint32_t number) const {
  const auto newest = std::find_if(all.rbegin(), all.rend(), [&](const Correction& one) {
    return one.field == CorrectedField::Marker && one.part == part && one.marker == number;
  });
  return newest == all.rend() ? nullptr : &newest->new_value;
}

bool Corrections::has_removed_marker(std::uint32_t part, std::uint32_t number) const {
  return std::ranges::any_of(all, [&](const Correction& one) {
    return one.field == CorrectedField::Marker && one.part == part && one.marker == number && one.new_value.empty();
  });
}

bool Corrections::has_removed(CorrectedField field) const {
  return std::ranges::any_of(all, [field](const Correction& one) { return one.field == field && one.new_value.empty(); });
}

void Corrections::add(Correction correction) {
  correction.number = static_cast<std::uint32_t>(all.size() + 1);
  all.push_back(std::move(correction));
  const Correction& added = all.back();
  if (!is_text(added.field) || !added.new_value.empty()) return;
  for (Correction& one : all) {
    if (one.field != added.field || one.part != added.part || one.marker != added.marker) continue;
    for (std::string* value : {&one.old_value, &one.new_value}) {
      if (!value->empty()) *value = kRemovedText;
    }
  }
}

std::string corrections_file(const std::string& recording, const std::string& session_id) {
  return (std::filesystem::path(recording).parent_path() / (session_id + std::string(kCorrectionsEnding))).string();
}

core::Result<Corrections> read_corrections(const std::string& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (status.type() == std::filesystem::file_type::not_found) return core::fail(ErrorCode::NotFound, "no file '" + file + "'");
  if (!std::filesystem::is_regular_file(status)) return damaged_corrections(file, "it is not a file");
  if (std::filesystem::file_size(file, error) > kLongestCorrections || error) return damaged_corrections(file, "it is larger than 16 MiB");
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream.good() && !stream.eof()) return damaged_corrections(file, "reading failed");
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("corrections") || !json["corrections"].is_array())
    return damaged_corrections(file, "it has no corrections");
  CorrectionReader reader(json);
  Corrections read{.session_id = reader.text("session_id")};
  if (read.session_id.empty()) return damaged_corrections(file, "it names no session");
  if (json["corrections"].size() > kMostListed) {
    return damaged_corrections(file, "it has more than " + std::to_string(kMostListed) + " corrections");
  }
  for (const Json& object : json["corrections"]) {
    DTS_TRY_ASSIGN(auto correction, read_correction(object, file, static_cast<std::uint32_t>(read.all.size() + 1)));
    read.all.push_back(std::move(correction));
  }
  return read;
}

core::Result<Corrections> corrections_beside(const std::string& recording, const SessionFacts& facts) {
  const bool is_ours = !facts.session_id.empty() && is_id(facts.session_id);
  if (!is_ours) return Corrections{};  // a recording of another program, or a forged ID that would be a path
  const std::string file = corrections_file(recording, facts.session_id);
  auto read = read_corrections(file);
  if (!read && read.error().code == ErrorCode::NotFound) return Corrections{.session_id = facts.session_id};
  if (read && read->session_id != facts.session_id) return damaged_corrections(file, "it names another session");
  return read;
}

core::Status write_corrections(const std::string& file, const Corrections& corrections) {
  Json json{{"session_id", corrections.session_id}, {"corrections", Json::array()}};
  for (const Correction& correction : corrections.all) json["corrections"].push_back(json_of(correction));
  return replace_file(file, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", 0640);
}

SessionFacts corrected(SessionFacts facts, const Corrections& corrections) {
  if (const std::string* subject = corrections.value(CorrectedField::Subject)) facts.subject = *subject;
  if (const std::string* label = corrections.value(CorrectedField::Label)) facts.label = *label;
  return facts;
}

}  // namespace dts::record
