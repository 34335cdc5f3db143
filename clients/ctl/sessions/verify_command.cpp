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
#include "record/losses.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::ctl {
namespace {

/// What came out of one file.
struct Verified {
  RecordedFile file;
  record::Verification found{};
  core::Losses losses{};  ///< Of scans: the file is sound, and says itself what is missing in it.
  std::optional<core::Error> problem{};
};

Verified verify(const RecordedFile& file, cli::Console& console) {
  cli::Progress bar(console, "verifying " + std::filesystem::path(file.path).filename().string());
  auto found = record::verify(file.path, [&bar](std::uint64_t done, std::uint64_t of) {
    bar.report(of > 0 ? static_cast<double>(done) / static_cast<double>(of) : 1.0);
    return true;
  });
  if (!found) return {.file = file, .problem = found.error()};
  Verified verified{.file = file, .found = std::move(*found)};
  if (const auto recording = record::Recording::open(file.path)) verified.losses = (*recording)->losses();
  if (!file.sha256.empty() && file.sha256 != verified.found.sha256) {
    verified.problem =
        core::Error{core::ErrorCode::DataDamaged,
                    "it is not the file that was recorded: SHA-256 " + verified.found.sha256 + ", in the catalogue " + file.sha256,
                    "restore it from a backup"};
  }
  return verified;
}

/// What is wrong with the file; a message that begins with the file's name loses it.
std::string problem_of(const Verified& verified) {
  const std::string name = verified.file.path + ": ";
  const std::string& what = verified.problem->what;
  return what.starts_with(name) ? what.substr(name.size()) : what;
}

/// One of the words that the catalogue has for recordings.
std::string state_of(const record::Verification& found) {
  if (found.is_recovered) return "recovered";
  if (!found.is_closed) return "interrupted";
  return found.incomplete.empty() ? "complete" : "incomplete";
}

std::string reason_of(const record::Verification& found) {
  if (!found.incomplete.empty()) return found.incomplete;
  return found.is_closed ? "" : "it was never closed";
}

cli::Json to_json(const Verified& verified) {
  const record::Verification& found = verified.found;
  cli::Json json{{"file", verified.file.path}, {"ok", !verified.problem}};
  if (verified.file.part > 0) json["part"] = verified.file.part;
  if (verified.problem) json["problem"] = verified.problem->what;
  if (found.sha256.empty()) return json;
  json["state"] = state_of(found);
  if (!reason_of(found).empty()) json["reason"] = reason_of(found);
  json["sha256"] = found.sha256;
  json["bytes"] = found.bytes;
  json["chunks"] = found.chunks;
  json["scans"] = found.scans;
  cli::set_number(json, "duration_s", found.duration_s);
  json["has_index"] = found.has_index;
  json["is_closed"] = found.is_closed;
  json["is_recovered"] = found.is_recovered;
  cli::set_number(json, "lost_s_at_most", found.lost_s_at_most);
  json["gaps"] = verified.losses.total().gaps;
  json["lost_scans"] = verified.losses.total().scans;
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
  std::string word = state_of(found);
  const std::string losses = to_text(verified.losses);
  std::string facts = cli::duration(found.duration_s) + ", " + std::to_string(found.scans) + " scans, " + bytes_text(found.bytes);
  facts += ", " + std::to_string(found.chunks) +
           (found.has_index ? " chunks as the index has them" : " chunks; no .idx beside it: the values were not checked");
  if (!losses.empty()) facts += ", " + cli::styled(console, cli::Style::Warning, losses);
  if (word == "complete") {
    console.out << cli::styled(console, cli::Style::Good, found.has_index ? "sound" : "readable") << "  " << name << ": complete, " << facts
                << '\n';
  } else {
    std::ranges::transform(word, word.begin(), [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
    const std::string lost = found.lost_s_at_most > 0.0 ? "; at most " + cli::decimal(found.lost_s_at_most, 2) + " s are lost" : "";
    console.out << cli::styled(console, cli::Style::Bad, word) << "  " << name << ": sound as far as it goes, but "
                << cli::printable(reason_of(found)) << lost << "; " << facts << '\n';
  }
  console.out << cli::styled(console, cli::Style::Faint, "SHA-256 " + cli::printable(found.sha256)) << '\n';
}

}  // namespace

int run_session_verify(const Arguments& arguments, cli::Console& console) {
  const auto files = find_recordings(arguments);
  if (!files) return cli::fail_with(console, files.error());
  int status = cli::kOk;
  cli::Json list = cli::Json::array();
  for (const RecordedFile& file : *files) {
    const Verified verified = verify(file, console);
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
  if (arguments.is_json) console.out << cli::document({{"ok", status == cli::kOk}, {"files", std::move(list)}});
  console.out.flush();
  return status;
}

}  // namespace dts::ctl
