// SPDX-License-Identifier: Apache-2.0
#include "ctl/sessions/verify_command.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/progress.h"
#include "cli/table.h"
#include "core/losses.h"
#include "ctl/recording_view.h"
#include "ctl/sessions/recorded_files.h"
#include "record/catalogue/trial_collector.h"
#include "record/losses.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "report/recorded_definitions.h"

namespace dts::ctl {
namespace {

/// Counts from one recording, or from all recordings of a session.
struct Counts {
  core::LossCount lost{};
  std::uint64_t valid_trials = 0;
  std::uint64_t planned_trials = 0;
};

/// The result for one file.
struct Verified {
  RecordedFile file;
  record::Verification found{};
  core::Losses losses{};  ///< Losses of scans: the file itself is sound and lists them.
  Counts counts{};
  std::optional<core::Error> problem{};
};

/// Collects the counts in the recording.
void count(record::Recording& recording, Verified& verified) {
  verified.losses = recording.losses();
  Counts& counts = verified.counts;
  counts.lost = verified.losses.total();
  const auto corrections = record::corrections_beside(verified.file.path, recording.session().value_or(record::SessionFacts{}));
  if (!corrections) verified.problem = corrections.error();
  // The trials of a session are those of its leading rig.
  const bool leads = recording.session() && recording.session()->leading_part == 0;
  if (leads) counts.planned_trials = report::planned_trials(*recording.session());
  if (counts.planned_trials == 0) return;  // without planned trials there is nothing to find
  record::TrialCollector trials(recording.find_stream("raw"));
  for (auto item = recording.next(); item && *item; item = recording.next()) trials.add(**item);
  auto rows = trials.rows();
  for (record::TrialRow& row : rows) {
    const std::string* outcome = corrections ? corrections->outcome(recording.session()->part, row.trial, row.attempt) : nullptr;
    if (outcome != nullptr) row.outcome = *outcome;
  }
  counts.valid_trials = static_cast<std::uint64_t>(std::ranges::count_if(rows, record::is_valid));
}

Verified verify(const RecordedFile& file, cli::Console& console) {
  cli::Progress bar(console, "verifying " + std::filesystem::path(file.path).filename().string());
  auto found = record::verify(file.path, [&bar](std::uint64_t done, std::uint64_t of) {
    bar.report(of > 0 ? static_cast<double>(done) / static_cast<double>(of) : 1.0);
    return true;
  });
  if (!found) return {.file = file, .problem = found.error()};
  Verified verified{.file = file, .found = std::move(*found)};
  if (const auto recording = record::Recording::open(file.path)) count(**recording, verified);
  if (!file.sha256.empty() && file.sha256 != verified.found.sha256) {
    verified.problem =
        core::Error{core::ErrorCode::DataDamaged,
                    "it differs from the recorded file: SHA-256 " + verified.found.sha256 + ", in the catalogue " + file.sha256,
                    "restore it from a backup"};
  }
  return verified;
}

/// Returns what is wrong with the file, without the file's name at the beginning.
std::string problem_of(const Verified& verified) {
  const std::string name = verified.file.path + ": ";
  const std::string& what = verified.problem->what;
  return what.starts_with(name) ? what.substr(name.size()) : what;
}

std::string state_of(const Verified& verified) { return std::string(record::name(record::state_of(verified.found, verified.file.path))); }

std::string reason_of(const Verified& verified) { return record::reason_of(verified.found, verified.file.path); }

void add_counts(const Counts& counts, cli::Json& json) {
  json["gaps"] = counts.lost.gaps;
  json["lost_scans"] = counts.lost.scans;
  json["valid_trials"] = counts.valid_trials;
  json["planned_trials"] = counts.planned_trials;
}

cli::Json to_json(const Verified& verified) {
  const record::Verification& found = verified.found;
  cli::Json json{{"file", verified.file.path}, {"ok", !verified.problem}};
  if (verified.file.part > 0) json["part"] = verified.file.part;
  if (verified.problem) json["problem"] = verified.problem->what;
  if (found.sha256.empty()) return json;
  json["state"] = state_of(verified);
  if (!reason_of(verified).empty()) json["reason"] = reason_of(verified);
  json["sha256"] = found.sha256;
  json["bytes"] = found.bytes;
  json["chunks"] = found.chunks;
  json["scans"] = found.scans;
  cli::set_number(json, "duration_s", found.duration_s);
  json["has_index"] = found.has_index;
  json["is_closed"] = found.is_closed;
  json["is_recovered"] = found.is_recovered;
  cli::set_number(json, "lost_s_at_most", found.lost_s_at_most);
  add_counts(verified.counts, json);
  json["losses"] = cli::Json::parse(record::to_json(verified.losses));
  return json;
}

void print_verified(cli::Console& console, const Verified& verified) {
  const record::Verification& found = verified.found;
  const std::string name = cli::printable(verified.file.path);
  if (verified.problem) {
    console.out << cli::styled(console, cli::Style::Bad, "DAMAGED") << "  " << name << ": " << cli::printable(problem_of(verified)) << '\n';
    return;
  }
  std::string word = state_of(verified);
  const std::string losses = to_text(verified.losses);
  std::string facts = cli::duration(found.duration_s) + ", " + std::to_string(found.scans) + " scans, " + bytes_text(found.bytes);
  facts += ", " + std::to_string(found.chunks) +
           (found.has_index ? " chunks, all checksums match" : " chunks; no .idx file beside it: the values were not checked");
  const std::string trials = trials_text(verified.counts.valid_trials, verified.counts.planned_trials);
  if (!trials.empty()) facts += ", " + trials;
  if (!losses.empty()) facts += ", " + cli::styled(console, cli::Style::Warning, losses);
  if (word == "complete") {
    console.out << cli::styled(console, cli::Style::Good, found.has_index ? "sound" : "readable") << "  " << name << ": complete, " << facts
                << '\n';
  } else {
    std::ranges::transform(word, word.begin(), [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
    const std::string lost = found.lost_s_at_most > 0.0 ? "; at most " + cli::decimal(found.lost_s_at_most, 2) + " s lost" : "";
    console.out << cli::styled(console, cli::Style::Bad, word) << "  " << name << ": undamaged up to its end, but "
                << cli::printable(reason_of(verified)) << lost << "; " << facts << '\n';
  }
  console.out << cli::styled(console, cli::Style::Faint, "SHA-256 " + cli::printable(found.sha256)) << '\n';
}

}  // namespace

int run_session_verify(const Arguments& arguments, cli::Console& console) {
  const auto files = find_recordings(arguments);
  if (!files) return cli::fail_with(console, files.error());
  int status = cli::kOk;
  cli::Json list = cli::Json::array();
  Counts all;
  for (const RecordedFile& file : *files) {
    const Verified verified = verify(file, console);
    all.lost.gaps += verified.counts.lost.gaps;
    all.lost.scans += verified.counts.lost.scans;
    all.valid_trials += verified.counts.valid_trials;
    all.planned_trials = std::max(all.planned_trials, verified.counts.planned_trials);
    if (arguments.is_json) {
      list.push_back(to_json(verified));
    } else {
      print_verified(console, verified);
    }
    if (verified.problem) {
      const core::Error& problem = *verified.problem;
      status = cli::fail_with(console, core::Error{problem.code, file.path + ": " + problem_of(verified), problem.hint});
    }
    const bool can_recover = !verified.problem && !verified.found.is_closed && !verified.found.is_recovered;
    if (can_recover) cli::print_hint(console, "repair a copy: dtsctl session recover " + cli::printable(file.path));
  }
  if (arguments.is_json) {
    cli::Json json{{"ok", status == cli::kOk}, {"files", std::move(list)}};
    add_counts(all, json);
    console.out << cli::document(json);
  }
  console.out.flush();
  return status;
}

}  // namespace dts::ctl
