// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "record/catalogue/catalogue.h"
#include "record/catalogue/recording_files.h"
#include "record/catalogue/trial_collector.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"

namespace dts::record {
namespace {

namespace fs = std::filesystem;
using core::ErrorCode;

constexpr double kLongestRecordingS = 1e9;
constexpr std::int64_t kLatestStartNs = 8'000'000'000'000'000'000;

bool is_gone(const std::string& file) {
  std::error_code error;
  const auto status = fs::status(file, error);
  return status.type() == fs::file_type::not_found;  // false if this user may not look at it
}

/// Also looks for the .part file, because the catalogue may know an open recording by its final name.
bool is_gone(const PartRow& part) { return is_gone(part.file) && (part.state != PartState::Recording || is_gone(part.file + ".part")); }

void set_state(const Verification& verified, PartRow& part) {
  part.bytes = verified.bytes;
  part.scans = verified.scans;
  part.duration_s = std::isfinite(verified.duration_s) ? verified.duration_s : 0.0;
  part.lost_s_at_most = verified.lost_s_at_most;
  part.state = state_of(verified, part.file);
  part.reason = reason_of(verified, part.file);
  if (verified.is_closed) part.sha256 = verified.sha256;
}

/// Fills the row of a file that does not pass verification.
void set_damaged(const core::Error& error, const Recording& recording, PartRow& part) {
  part.state = part.file.ends_with(".part") ? PartState::Interrupted : PartState::Incomplete;
  part.reason = error.what;
  std::error_code unknown;
  const auto bytes = fs::file_size(part.file, unknown);
  part.bytes = unknown ? 0 : bytes;
  part.duration_s = recording.duration_s();
  for (std::size_t stream = 0; stream < recording.streams().size(); ++stream) {
    if (recording.streams()[stream].rate) part.scans = std::max(part.scans, recording.sample_count(stream));
  }
}

std::string session_state(PartState state, bool is_aborted) {
  if (is_aborted) return "aborted";
  if (state == PartState::Complete) return "complete";
  return state == PartState::Incomplete ? "incomplete" : "interrupted";
}

std::int64_t end_of(const PartRow& part) {
  const bool is_sane =
      part.started_utc_ns >= 0 && part.started_utc_ns <= kLatestStartNs && part.duration_s >= 0.0 && part.duration_s <= kLongestRecordingS;
  return is_sane ? part.started_utc_ns + std::llround(part.duration_s * 1e9) : part.started_utc_ns;
}

/// Returns what the events of a recording say. Sets the names of the part in all rows, and no other field of it.
FoundRecording collect(Recording& recording, const std::string& session_id, std::uint32_t part) {
  TrialCollector trials(recording.find_stream("raw"));
  FoundRecording found;
  while (true) {
    const auto item = recording.next();
    if (!item || !*item) break;  // `verify` reports what cannot be read
    trials.add(**item);
    const auto* timed = std::get_if<TimedEvent>(&**item);
    if (timed != nullptr && timed->event.has_session()) found.session_state = timed->event.session().is_aborted() ? "aborted" : "";
  }
  found.part.session_id = session_id;
  found.part.part = part;
  found.trials = trials.rows();
  for (TrialRow& trial : found.trials) {
    trial.session_id = session_id;
    trial.part = part;
  }
  found.markers = trials.markers();
  for (MarkerRow& marker : found.markers) {
    marker.session_id = session_id;
    marker.part = part;
  }
  found.results = trials.session_results();
  for (ResultRow& result : found.results) result.session_id = session_id;
  found.begun_attempts = trials.begun_attempts();
  return found;
}

core::Result<FoundRecording> read_whole(const std::string& file, const SessionFacts& facts) {
  DTS_TRY_ASSIGN(auto recording, Recording::open(file));
  FoundRecording found = collect(*recording, facts.session_id, facts.part);
  found.facts = facts;
  found.part.rig = facts.rig;
  found.part.leading_part = leading_part(facts);
  if (!found.part.leads()) {
    found.trials.clear();
    found.results.clear();
    found.markers.clear();
  }
  found.part.file = file;
  found.part.started_utc_ns = facts.started_utc_ns;
  found.part.losses = recording->losses();
  const auto verified = verify(file);
  if (verified) {
    set_state(*verified, found.part);
  } else {
    set_damaged(verified.error(), *recording, found.part);
  }
  found.session_state = session_state(found.part.state, found.session_state == "aborted");
  found.ended_utc_ns = end_of(found.part);
  return found;
}

/// Returns true if the part is closed but its losses are not known.
bool lacks_losses(const PartRow& part) {
  const bool is_whole = part.state == PartState::Complete || part.state == PartState::Incomplete || part.state == PartState::Recovered;
  return is_whole && !part.losses;
}

class Rebuild {
 public:
  Rebuild(Catalogue& catalogue, std::vector<PartRow> known) : catalogue_(catalogue) {
    for (PartRow& part : known) {
      if (part.state != PartState::Missing) files_.insert(part.file);
      parts_.emplace(std::pair{part.session_id, part.part}, std::move(part));
    }
  }

  [[nodiscard]] core::Status fill_in();
  [[nodiscard]] core::Status consider(const std::string& file);
  [[nodiscard]] core::Status mark_missing();
  [[nodiscard]] core::Status read_corrections_in(const std::vector<std::string>& files);
  [[nodiscard]] Rebuilt take_result() { return std::move(result_); }

 private:
  struct FoundCorrections {
    std::string file;
    Corrections corrections;
    bool is_beside = false;  ///< Beside a recording that the catalogue knows.
  };

  [[nodiscard]] bool is_better(const PartRow& known, const std::string& file) const;
  [[nodiscard]] core::Status enter(const core::Result<FoundRecording>& found, const std::string& file, bool is_known);
  [[nodiscard]] std::map<std::string, FoundCorrections> best_corrections(const std::vector<std::string>& files);
  void write_beside(const Corrections& corrections, std::string file);

  Catalogue& catalogue_;
  std::map<std::pair<std::string, std::uint32_t>, PartRow> parts_;
  std::set<std::string> files_;
  Rebuilt result_;
};

/// Reads from the files what the catalogue lacks: losses, markers and attempts. They stay unknown if the file cannot be read.
core::Status Rebuild::fill_in() {
  DTS_TRY_ASSIGN(const auto without_events, catalogue_.parts_without_events());
  for (auto& [key, part] : parts_) {
    const bool lacks_events = without_events.contains(key) && part.state != PartState::Recording && part.state != PartState::Missing;
    if (!lacks_losses(part) && !lacks_events) continue;
    const auto recording = Recording::open(part.file);
    if (!recording) continue;
    if (lacks_losses(part)) {
      part.losses = (*recording)->losses();
      part.duration_s = (*recording)->duration_s();
      DTS_TRY(catalogue_.update_part(part));
    }
    if (lacks_events) DTS_TRY(catalogue_.enter_events(collect(**recording, part.session_id, part.part)));
    ++result_.read_again;
  }
  return {};
}

/// Returns true if `file` must replace the file that the catalogue knows for this part.
bool Rebuild::is_better(const PartRow& known, const std::string& file) const {
  if (known.state == PartState::Missing || is_gone(known)) return true;
  return known.state == PartState::Interrupted && rank(file) == FileRank::Repaired;
}

/// Adds a file if it is needed. Fails only if the catalogue fails; a bad file is listed in `unreadable`.
core::Status Rebuild::consider(const std::string& file) {
  if (files_.contains(file)) return {};
  const auto facts = read_session_facts(file);
  if (!facts) {
    result_.unreadable.push_back(file + ": " + facts.error().what);
    return {};
  }
  const auto known = parts_.find({facts->session_id, facts->part});
  const bool is_known = known != parts_.end();
  if (is_known && !is_better(known->second, file)) return {};
  const auto found = read_whole(file, *facts);
  const bool is_original_there = is_known && known->second.state == PartState::Interrupted && !is_gone(known->second);
  if (is_original_there && (!found || found->part.state != PartState::Recovered)) return {};  // the copy is not complete
  return enter(found, file, is_known);
}

core::Status Rebuild::enter(const core::Result<FoundRecording>& found, const std::string& file, bool is_known) {
  auto entered = found ? catalogue_.enter(*found) : core::Status(tl::make_unexpected(found.error()));
  if (entered) {
    ++(is_known ? result_.found_again : result_.added);
    parts_.insert_or_assign({found->part.session_id, found->part.part}, found->part);
    return {};
  }
  const ErrorCode code = entered.error().code;
  const bool is_of_the_file =
      !found || code == ErrorCode::InvalidArgument || code == ErrorCode::WrongState || code == ErrorCode::LimitExceeded;
  if (!is_of_the_file) return entered;
  result_.unreadable.push_back(file + ": " + entered.error().what);
  return {};
}

/// Makes the corrections in the catalogue and in the files beside the recordings equal. A problem of a file is listed in `unreadable`.
core::Status Rebuild::read_corrections_in(const std::vector<std::string>& files) {
  DTS_TRY_ASSIGN(const auto listed, catalogue_.corrections());
  std::map<std::string, Corrections> known;
  for (const Corrections& one : listed) known.emplace(one.session_id, one);
  for (const auto& [id, found] : best_corrections(files)) {
    const auto ours = known.find(id);
    const std::size_t count = ours == known.end() ? 0 : ours->second.all.size();
    // The catalogue has more if dtsd ended before it wrote the file. A file elsewhere is a copy: it may be old.
    const bool is_right = found.is_beside ? found.corrections.all.size() >= count : found.corrections.all.size() > count;
    if (is_right && (ours == known.end() || ours->second != found.corrections)) {
      if (auto set = catalogue_.set_corrections(found.corrections); !set) {
        if (set.error().code != ErrorCode::NotFound) return set;
        result_.unreadable.push_back(found.file + ": " + set.error().what);  // the recordings are elsewhere; keep the file
        continue;
      }
    }
    if (!is_right && ours == known.end()) continue;  // an empty copy
    const Corrections& right = is_right ? found.corrections : ours->second;
    if (!found.is_beside || right != found.corrections) write_beside(right, found.is_beside ? found.file : std::string());
    if (ours != known.end()) known.erase(ours);
  }
  for (const auto& [id, one] : known) write_beside(one, {});
  return {};
}

/// Returns the file to use for each session: one beside a recording that the catalogue knows, else any; among equals the longest.
std::map<std::string, Rebuild::FoundCorrections> Rebuild::best_corrections(const std::vector<std::string>& files) {
  std::map<std::string, FoundCorrections> best;
  for (const std::string& file : files) {
    auto read = read_corrections(file);
    if (!read) {
      result_.unreadable.push_back(read.error().what);
      continue;
    }
    const bool is_beside = std::ranges::any_of(parts_, [&](const auto& entry) {
      return entry.first.first == read->session_id && entry.second.state != PartState::Missing &&
             corrections_file(entry.second.file, read->session_id) == file;
    });
    FoundCorrections found{.file = file, .corrections = std::move(*read), .is_beside = is_beside};
    const auto place = best.find(found.corrections.session_id);
    const auto order = [](const FoundCorrections& one) { return std::pair(one.is_beside, one.corrections.all.size()); };
    if (place == best.end()) {
      best.emplace(found.corrections.session_id, std::move(found));
    } else if (order(place->second) < order(found)) {
      place->second = std::move(found);
    }
  }
  return best;
}

/// Writes corrections to `file`; if it is empty, to a new file beside the first recording.
void Rebuild::write_beside(const Corrections& corrections, std::string file) {
  if (file.empty()) {
    const auto part = std::ranges::find(parts_, corrections.session_id, [](const auto& entry) { return entry.first.first; });
    if (part == parts_.end() || part->second.state == PartState::Missing) return;
    file = corrections_file(part->second.file, corrections.session_id);
    std::error_code unknown;
    if (fs::exists(fs::symlink_status(file, unknown))) return;  // unreadable: listed, and never replaced
  }
  // The catalogue has them too, so a disk that cannot be written is no reason not to start.
  if (auto written = write_corrections(file, corrections); !written) result_.unreadable.push_back(written.error().what);
}

core::Status Rebuild::mark_missing() {
  for (auto& [key, part] : parts_) {
    if (!is_gone(part)) continue;
    ++result_.missing;
    if (part.state == PartState::Missing) continue;
    part.state = PartState::Missing;
    part.reason = "the file is missing";
    DTS_TRY(catalogue_.update_part(part));
  }
  return {};
}

}  // namespace

PartState state_of(const Verification& verified, const std::string& file) {
  if (!verified.is_closed) return PartState::Interrupted;
  if (verified.is_recovered || rank(file) == FileRank::Repaired)
    return PartState::Recovered;  // a copy without streams has no footer with `recovered`
  return verified.incomplete.empty() && verified.scans > 0 ? PartState::Complete : PartState::Incomplete;
}

std::string reason_of(const Verification& verified, const std::string& file) {
  const PartState state = state_of(verified, file);
  if (state == PartState::Interrupted) return "it was not closed: the daemon or the power failed during the recording";
  if (!verified.incomplete.empty() || state == PartState::Complete) return verified.incomplete;
  return state == PartState::Recovered ? "interrupted; this is the repaired copy" : "it contains no scan";
}

core::Result<FoundRecording> read_recording(const std::string& file) {
  DTS_TRY_ASSIGN(const auto facts, read_session_facts(file));
  return read_whole(file, facts);
}

core::Result<Rebuilt> rebuild(Catalogue& catalogue, const std::string& folder) {
  DTS_TRY_ASSIGN(const auto files, files_in(folder));
  for (const std::string& file : files.unfinished) {  // a later erasure would not find what they have
    std::error_code ignored;
    fs::remove(file, ignored);
  }
  DTS_TRY_ASSIGN(auto known, catalogue.parts());
  Rebuild rebuilding(catalogue, std::move(known));
  DTS_TRY(rebuilding.fill_in());
  for (const std::string& file : files.recordings) {
    DTS_TRY(rebuilding.consider(file));
  }
  DTS_TRY(rebuilding.mark_missing());
  DTS_TRY(rebuilding.read_corrections_in(files.corrections));
  return rebuilding.take_result();
}

}  // namespace dts::record
