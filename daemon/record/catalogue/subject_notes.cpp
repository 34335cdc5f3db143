// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/subject_notes.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>

#include "core/utf8.h"
#include "record/catalogue/corrections.h"
#include "record/catalogue/erasure.h"
#include "record/replace_file.h"

namespace dts::record {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;
using Json = nlohmann::ordered_json;

constexpr std::string_view kNotesEnding = ".json";
constexpr std::string_view kUnfinishedEnding = ".new";  ///< Of a file that a crash left while it was replaced.
constexpr std::uintmax_t kLongestNotesFile = 4U << 20U;
constexpr const char* kNotesHint = "check the permissions of the folder of the recordings and whether its disk is full or read-only";

std::string notes_folder(const std::string& recordings) { return recordings + "/subjects"; }
std::string notes_file(const std::string& recordings, const std::string& subject) {
  return notes_folder(recordings) + "/" + subject + std::string(kNotesEnding);
}
bool is_subject_id(const std::string& subject) { return !subject.empty() && subject.size() <= kLongestSubject && is_id(subject); }

tl::unexpected<core::Error> damaged_notes(const std::string& file, const std::string& why) {
  return core::fail(ErrorCode::DataDamaged, "the notes in '" + file + "' cannot be read: " + why,
                    "restore the file from a backup, or move it away; recordings are not affected");
}

/// Reads members of one object; `is_good` is false if one is missing or not valid.
struct NoteReader {
  const Json& object;
  bool is_good = true;

  std::string text(const char* key) {
    const auto found = object.find(key);
    if (found != object.end() && found->is_string()) {
      auto value = found->get<std::string>();
      if (value.size() <= kLongestCorrectionText && core::printable(value) == value) return value;
    }
    is_good = false;
    return {};
  }
  std::int64_t integer(const char* key, std::int64_t most) {
    const auto found = object.find(key);
    if (found != object.end() && found->is_number_integer()) {
      const auto value = found->get<std::int64_t>();
      if (value >= 0 && value <= most) return value;
    }
    is_good = false;
    return 0;
  }
  std::uint32_t number(const char* key) { return static_cast<std::uint32_t>(integer(key, 1'000'000'000)); }
  std::int64_t time_ns() { return integer("utc_ns", std::numeric_limits<std::int64_t>::max()); }
};

std::optional<SubjectNote> read_note(const Json& object) {
  if (!object.is_object()) return std::nullopt;
  NoteReader reader{object};
  SubjectNote note{.number = reader.number("number"), .utc_ns = reader.time_ns(), .who = reader.text("who"), .text = reader.text("text")};
  return reader.is_good ? std::optional(std::move(note)) : std::nullopt;
}

std::optional<PlannedSession> read_planned(const Json& object) {
  if (!object.is_object()) return std::nullopt;
  NoteReader reader{object};
  PlannedSession planned{.number = reader.number("number"),
                         .utc_ns = reader.time_ns(),
                         .who = reader.text("who"),
                         .protocol = reader.text("protocol"),
                         .due_date = reader.text("due_date")};
  const bool is_good = reader.is_good && (planned.due_date.empty() || is_date(planned.due_date));
  return is_good ? std::optional(std::move(planned)) : std::nullopt;
}

/// Adds the entries of a list. Returns false if it is no list, too long, or has an entry that is not valid or not in order.
template <class Entry, class Read>
bool add_entries(const Json& json, const char* key, std::size_t most, std::uint32_t next_number, Read read, std::vector<Entry>& entries) {
  const auto list = json.find(key);
  if (list == json.end() || !list->is_array() || list->size() > most) return false;
  for (const Json& object : *list) {
    auto entry = read(object);
    if (!entry || entry->number >= next_number || (!entries.empty() && entry->number <= entries.back().number)) return false;
    entries.push_back(std::move(*entry));
  }
  return true;
}

}  // namespace

bool is_date(const std::string& text) {
  if (text.size() != 10 || text[4] != '-' || text[7] != '-') return false;
  const auto number = [&text](std::size_t at, std::size_t length) {
    int value = -1;
    const char* const end = text.data() + at + length;
    const auto [stop, failed] = std::from_chars(text.data() + at, end, value);
    return failed == std::errc() && stop == end ? value : -1;
  };
  const int month = number(5, 2);
  const int day = number(8, 2);
  if (number(0, 4) < 1970 || month < 1 || day < 1) return false;
  return std::chrono::year_month_day(std::chrono::year(number(0, 4)), std::chrono::month(static_cast<unsigned>(month)),
                                     std::chrono::day(static_cast<unsigned>(day)))
      .ok();
}

core::Result<SubjectNotes> read_subject_notes(const std::string& recordings, const std::string& subject) {
  SubjectNotes read{.subject = subject};
  if (!is_subject_id(subject)) return read;
  const std::string file = notes_file(recordings, subject);
  std::error_code error;
  const auto status = fs::symlink_status(file, error);
  if (status.type() == fs::file_type::not_found) return read;
  if (!fs::is_regular_file(status)) return damaged_notes(file, "it is not a file");
  if (fs::file_size(file, error) > kLongestNotesFile || error) return damaged_notes(file, "it is larger than 4 MiB");
  std::ifstream stream(file, std::ios::binary);
  const Json json = Json::parse(std::istreambuf_iterator<char>(stream), {}, nullptr, false);
  if (!json.is_object()) return damaged_notes(file, "it is not JSON");
  NoteReader reader{json};
  const bool is_same = reader.text("subject") == subject;
  read.next_number = reader.number("next_number");
  if (!reader.is_good || !is_same) return damaged_notes(file, "it names another subject");
  const bool is_good = add_entries(json, "notes", kMostSubjectNotes, read.next_number, read_note, read.notes) &&
                       add_entries(json, "plan", kMostPlanned, read.next_number, read_planned, read.plan);
  if (!is_good) return damaged_notes(file, "an entry is not valid");
  return read;
}

core::Status write_subject_notes(const std::string& recordings, const SubjectNotes& notes) {
  if (!is_subject_id(notes.subject)) return core::fail(ErrorCode::InvalidArgument, "this is no subject ID");
  if (notes.is_empty() && notes.next_number == 1) {
    DTS_TRY(remove_subject_notes(recordings, notes.subject));
    return {};
  }
  const std::string folder = notes_folder(recordings);
  if (::mkdir(folder.c_str(), 0750) == 0) {
    synchronise_folder(recordings);
  } else if (errno != EEXIST) {
    return core::fail_errno(errno, "cannot make the folder '" + folder + "'", kNotesHint);
  }
  Json json{{"subject", notes.subject}, {"next_number", notes.next_number}, {"notes", Json::array()}, {"plan", Json::array()}};
  for (const SubjectNote& note : notes.notes) {
    json["notes"].push_back({{"number", note.number}, {"utc_ns", note.utc_ns}, {"who", note.who}, {"text", note.text}});
  }
  for (const PlannedSession& one : notes.plan) {
    json["plan"].push_back(
        {{"number", one.number}, {"utc_ns", one.utc_ns}, {"who", one.who}, {"protocol", one.protocol}, {"due_date", one.due_date}});
  }
  return replace_file(notes_file(recordings, notes.subject), json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n", 0640);
}

core::Result<std::uint32_t> remove_subject_notes(const std::string& recordings, const std::string& subject) {
  std::uint32_t removed = 0;
  if (!is_subject_id(subject)) return removed;
  const std::string file = notes_file(recordings, subject);
  for (const std::string& one : {file, file + std::string(kUnfinishedEnding)}) {
    const bool is_gone = ::unlink(one.c_str()) == 0;
    if (!is_gone && errno != ENOENT) return core::fail_errno(errno, "cannot remove '" + one + "'", kNotesHint);
    if (is_gone) ++removed;
  }
  synchronise_folder(notes_folder(recordings));
  return removed;
}

core::Result<std::vector<std::string>> subjects_with_notes(const std::string& recordings) {
  std::vector<std::string> subjects;
  std::error_code error;
  fs::directory_iterator entries(notes_folder(recordings), error);
  if (error == std::errc::no_such_file_or_directory) return subjects;
  for (; !error && entries != fs::directory_iterator(); entries.increment(error)) {
    std::string name = entries->path().filename().string();
    if (name.ends_with(kUnfinishedEnding)) name.resize(name.size() - kUnfinishedEnding.size());
    if (!name.ends_with(kNotesEnding)) continue;
    std::string subject = name.substr(0, name.size() - kNotesEnding.size());
    if (is_subject_id(subject)) subjects.push_back(std::move(subject));
  }
  if (error) return core::fail_errno(error.value(), "cannot read the folder '" + notes_folder(recordings) + "'", kNotesHint);
  std::ranges::sort(subjects);
  subjects.erase(std::ranges::unique(subjects).begin(), subjects.end());
  return subjects;
}

core::Result<std::vector<std::string>> remove_mentions_in_notes(const std::string& recordings, const std::string& subject) {
  DTS_TRY_ASSIGN(const auto subjects, subjects_with_notes(recordings));
  std::vector<std::string> unread;
  for (const std::string& other : subjects) {
    if (other == subject) continue;
    const std::string unfinished = notes_file(recordings, other) + std::string(kUnfinishedEnding);
    if (::unlink(unfinished.c_str()) != 0 && errno != ENOENT) unread.push_back(unfinished);
    auto notes = read_subject_notes(recordings, other);
    if (!notes) {
      unread.push_back(notes_file(recordings, other));
      continue;
    }
    bool is_changed = false;
    for (SubjectNote& note : notes->notes) {
      auto cleaned = without_mention(note.text, subject);
      if (!cleaned) continue;
      note.text = std::move(*cleaned);
      is_changed = true;
    }
    if (is_changed) DTS_TRY(write_subject_notes(recordings, *notes));
  }
  return unread;
}

std::string without_subjects(const std::string& recordings, std::string message) {
  const std::string folder = notes_folder(recordings) + "/";
  for (std::size_t at = message.find(folder); at != std::string::npos; at = message.find(folder, at)) {
    at += folder.size();
    message.replace(at, message.find('\'', at) - at, "ID" + std::string(kNotesEnding));
  }
  return message;
}

}  // namespace dts::record
