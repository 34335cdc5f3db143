// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/status_view.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/table.h"
#include "core/clock.h"
#include "core/utc_text.h"
#include "fleet/forward/status_words.h"
#include "fleet/wire/messages.h"

namespace dts::fleet::forward {
namespace {

using Words = std::map<std::string, std::string>;

constexpr std::int64_t kLongestSilenceNs = 15 * core::kNanosecondsPerSecond;
constexpr double kBytesPerMegabyte = 1e6;
constexpr double kNsPerS = 1e9;
constexpr double kNsPerMs = 1e6;

std::string word(const Words& words, const char* name) {
  const auto found = words.find(name);
  return found == words.end() ? std::string() : found->second;
}

template <class Number>
Number number(const Words& words, const char* name) {
  const std::string text = word(words, name);
  Number value{};
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::string_view name(FileState state) noexcept {
  switch (state) {
    case FileState::Waiting: return "waiting";
    case FileState::Stored: return "stored";
    case FileState::Held: return "held";
  }
  return "unknown";
}

std::string megabytes(std::uint64_t bytes) { return cli::decimal(static_cast<double>(bytes) / kBytesPerMegabyte, 1) + " MB"; }

std::string ago(std::int64_t utc_ns, std::int64_t now_ns) {
  if (utc_ns == 0) return "never";
  return cli::duration(std::max(0.0, static_cast<double>(now_ns - utc_ns) / kNsPerS)) + " ago";
}

/// What `dts-forward status` shows, from the store.
struct Facts {
  v1::Backlog backlog;
  Words words;
  std::vector<FileRow> held;
  std::vector<std::pair<std::string, std::string>> rejected;
  bool is_running = false;
  std::optional<double> seconds_to_go{};
  std::string problem{};
};

/// The first reason why something waits; empty: nothing prevents it.
std::string problem_of(const Facts& facts) {
  if (!facts.is_running) return "dts-forward does not run";
  for (const char* name : {words::kLinkProblem, words::kBeatProblem, words::kDeskProblem, words::kUploadProblem, words::kOutboxProblem}) {
    if (const std::string problem = word(facts.words, name); !problem.empty()) return problem;
  }
  return {};
}

core::Result<Facts> facts_of(const Store& store, std::int64_t utc_ns) {
  Facts facts;
  DTS_TRY_ASSIGN(facts.backlog, store.backlog());
  DTS_TRY_ASSIGN(facts.words, store.words());
  DTS_TRY_ASSIGN(facts.held, store.held());
  DTS_TRY_ASSIGN(facts.rejected, store.rejected_facts());
  facts.is_running = std::llabs(utc_ns - number<std::int64_t>(facts.words, words::kUpdated)) < kLongestSilenceNs;
  const auto rate = number<double>(facts.words, words::kUploadRate);
  const std::uint64_t have = number<std::uint64_t>(facts.words, words::kUploadHave);
  const std::uint64_t left = facts.backlog.bytes() - std::min(facts.backlog.bytes(), have);
  facts.problem = problem_of(facts);
  const bool is_sending =
      facts.is_running && word(facts.words, words::kLinkProblem).empty() && word(facts.words, words::kUploadProblem).empty();
  if (is_sending && facts.backlog.files() > 0 && rate > 0.0) facts.seconds_to_go = static_cast<double>(left) / rate;
  return facts;
}

cli::Json json_of(const FileRow& file) {
  cli::Json out = {{"session", file.session},        {"part", file.part},  {"state", name(file.state)}, {"bytes", file.bytes},
                   {"sha256", file.recorded_sha256}, {"tries", file.tries}};
  if (!file.sent_sha256.empty()) out["sent_sha256"] = file.sent_sha256;
  if (file.receipt_utc_ns != 0) out["receipt_utc"] = core::utc_text(file.receipt_utc_ns);
  if (!file.hub.empty()) out["hub"] = file.hub;
  if (!file.why_not.empty()) out["why_not"] = file.why_not;
  return out;
}

cli::Json json_of(const Facts& facts, const std::string& clinic) {
  cli::Json out = {{"clinic", clinic},
                   {"is_running", facts.is_running},
                   {"backlog_files", facts.backlog.files()},
                   {"backlog_bytes", facts.backlog.bytes()},
                   {"held_files", facts.backlog.held_files()}};
  if (facts.backlog.oldest_utc_ns() != 0) out["oldest_utc"] = core::utc_text(facts.backlog.oldest_utc_ns());
  if (facts.backlog.last_receipt_utc_ns() != 0) out["last_receipt_utc"] = core::utc_text(facts.backlog.last_receipt_utc_ns());
  if (!facts.problem.empty()) out["problem"] = facts.problem;
  if (const std::string session = word(facts.words, words::kUploadSession); facts.is_running && !session.empty()) {
    out["sending"] = {{"session", session},
                      {"part", number<std::uint32_t>(facts.words, words::kUploadPart)},
                      {"bytes", number<std::uint64_t>(facts.words, words::kUploadBytes)},
                      {"have", number<std::uint64_t>(facts.words, words::kUploadHave)},
                      {"bytes_per_s", number<double>(facts.words, words::kUploadRate)}};
  }
  if (facts.seconds_to_go) out["to_go_s"] = *facts.seconds_to_go;
  if (const std::string hub = word(facts.words, words::kHub); !hub.empty()) {
    out["hub"] = hub;
    out["answered_utc"] = core::utc_text(number<std::int64_t>(facts.words, words::kBeat));
    out["clock_offset_ms"] = static_cast<double>(number<std::int64_t>(facts.words, words::kClockOffset)) / kNsPerMs;
  }
  if (const std::string head = word(facts.words, words::kAuditHead); !head.empty()) out["audit_head"] = head;
  if (facts.is_running) out["viewers"] = word(facts.words, words::kViewers);
  out["files_with_reason"] = cli::Json::array();
  for (const FileRow& file : facts.held) out["files_with_reason"].push_back(json_of(file));
  out["rejected_sessions"] = cli::Json::array();
  for (const auto& [session, why_not] : facts.rejected) out["rejected_sessions"].push_back({{"session", session}, {"why_not", why_not}});
  return out;
}

void print_line(cli::Console& console, const std::string& title, const std::string& text) {
  constexpr std::size_t kColumn = 16;
  console.out << title << std::string(kColumn - std::min(title.size(), kColumn - 1), ' ')
              << cli::wrapped_at(console, kColumn, cli::printable(text)) << '\n';
}

void print_text(const Facts& facts, const std::string& clinic, std::int64_t utc_ns, cli::Console& console) {
  const v1::Backlog& backlog = facts.backlog;
  print_line(console, "clinic", clinic);
  print_line(console, "state", facts.problem.empty() ? "fine" : facts.problem);
  print_line(console, "to send",
             std::to_string(backlog.files()) + (backlog.files() == 1 ? " recording, " : " recordings, ") + megabytes(backlog.bytes()));
  if (backlog.oldest_utc_ns() != 0) print_line(console, "oldest", "recorded " + ago(backlog.oldest_utc_ns(), utc_ns));
  if (const std::string session = word(facts.words, words::kUploadSession); facts.is_running && !session.empty()) {
    print_line(console, "sending",
               session + ", part " + word(facts.words, words::kUploadPart) + ": " +
                   megabytes(number<std::uint64_t>(facts.words, words::kUploadHave)) + " of " +
                   megabytes(number<std::uint64_t>(facts.words, words::kUploadBytes)));
  }
  if (facts.seconds_to_go) print_line(console, "time to go", cli::duration(*facts.seconds_to_go));
  print_line(console, "last receipt", ago(backlog.last_receipt_utc_ns(), utc_ns));
  if (const std::string hub = word(facts.words, words::kHub); !hub.empty()) {
    print_line(console, "centre", hub + ", answered " + ago(number<std::int64_t>(facts.words, words::kBeat), utc_ns));
    print_line(console, "clock",
               cli::decimal(static_cast<double>(number<std::int64_t>(facts.words, words::kClockOffset)) / kNsPerMs, 0) +
                   " ms ahead of the centre's");
  }
  if (const std::string head = word(facts.words, words::kAuditHead); !head.empty()) print_line(console, "audit head", head);
  if (const std::string viewers = word(facts.words, words::kViewers); facts.is_running && !viewers.empty())
    print_line(console, "watching now", viewers);
  cli::Table table({"SESSION", ">PART", "STATE", "WHY NOT SENT"});
  for (const FileRow& file : facts.held)
    table.add({{file.session}, {std::to_string(file.part)}, {std::string(name(file.state))}, {file.why_not}});
  for (const auto& [session, why_not] : facts.rejected) table.add({{session}, {"-"}, {"rejected"}, {why_not}});
  table.print(console);
}

}  // namespace

int print_status(const Store& store, const std::string& clinic, std::int64_t utc_ns, bool is_json, cli::Console& console) {
  const auto facts = facts_of(store, utc_ns);
  if (!facts) return cli::fail_with(console, facts.error());
  if (is_json) {
    console.out << cli::document(json_of(*facts, clinic));
  } else {
    print_text(*facts, clinic, utc_ns, console);
  }
  return facts->is_running ? cli::kOk : cli::kFailed;
}

int print_file(const Store& store, const std::string& sha256, bool is_json, cli::Console& console) {
  if (const auto bytes = wire::bytes_of_hex(sha256); !bytes) return cli::fail_with(console, bytes.error());
  const auto files = store.find(sha256);
  if (!files) return cli::fail_with(console, files.error());
  if (files->empty()) {
    return cli::fail_with(console, core::Error{core::ErrorCode::NotFound, "no recording with SHA-256 " + sha256 + " is known here",
                                               "dtsctl session show ID prints the checksums of a session"});
  }
  const auto stored = std::ranges::find(*files, FileState::Stored, &FileRow::state);
  const FileRow& file = stored == files->end() ? files->front() : *stored;
  if (is_json) {
    console.out << cli::document(json_of(file));
  } else if (file.state == FileState::Stored) {
    console.out << "the centre (" << cli::printable(file.hub) << ") has given a receipt for part " << file.part << " of session "
                << file.session << " at " << core::utc_text(file.receipt_utc_ns) << " (as known here)\n";
  }
  if (file.state == FileState::Stored) return cli::kOk;
  const std::string reason = file.why_not.empty() ? std::string("it waits to be sent") : file.why_not;
  return cli::fail_with(
      console, core::Error{core::ErrorCode::WrongState,
                           "there is no receipt for part " + std::to_string(file.part) + " of session " + file.session + ": " + reason,
                           "keep the recording"});
}

}  // namespace dts::fleet::forward
