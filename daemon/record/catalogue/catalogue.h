// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/losses.h"
#include "core/result.h"
#include "dts/v1/sessions.pb.h"
#include "record/catalogue/audit_chain.h"
#include "record/catalogue/corrections.h"
#include "record/session_facts.h"
#include "record/xdf/recovery.h"

namespace dts::record {

/// State of one recording. Every program shows it unless it is Complete.
enum class PartState : std::uint8_t {
  Recording = 1,  ///< Being written. If the daemon finds this state when it starts, the part was interrupted.
  Complete,
  Incomplete,   ///< Closed, but data is missing: write error, disk full, scans lost because a queue was full.
  Interrupted,  ///< The daemon or the power failed during the recording; there is no repaired copy yet.
  Recovered,    ///< Interrupted, with a repaired copy.
  Missing,      ///< The file does not exist any more.
};
[[nodiscard]] std::string_view name(PartState state) noexcept;

/// One file of a session.
struct PartRow {
  std::string session_id;
  std::uint32_t part = 1;
  std::string file;  ///< Path; the path of the repaired copy if there is one.
  PartState state = PartState::Recording;
  std::string sha256;  ///< Empty until closed.
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
  double duration_s = 0.0;  ///< From the first scan to the end of the last, gaps included.
  /// Between the first scan and the last. Absent: not known, because the recording is not closed yet or its file cannot be read.
  std::optional<core::Losses> losses{};
  double lost_s_at_most = 0.0;  ///< Of a recovered recording: time lost after its last scan, upper limit.
  std::string reason;           ///< Why it is not complete.
  std::int64_t started_utc_ns = 0;
  std::uint32_t valid_trials = 0;  ///< The catalogue counts the part's valid trials. `update_part` ignores this field and the next two.
  std::string rig{};
  std::uint32_t leading_part = 0;  ///< See `leading_part` of the facts.

  /// Returns whether this part has the trials of its session: it is not one of a companion.
  [[nodiscard]] bool leads() const noexcept { return leading_part == part; }

  friend bool operator==(const PartRow&, const PartRow&) = default;
};

struct TrialRow {
  std::string session_id;
  std::uint32_t part = 1;
  std::uint32_t trial = 0;  ///< Number in the plan, from 1.
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition;
  std::string outcome;           ///< "done", "redone", "rejected", "aborted"
  std::uint32_t segment = 0;     ///< Of `first_scan`.
  std::uint64_t first_scan = 0;  ///< First measured scan; if the trial ended before it was measured, the scan of its latest phase.
  std::uint64_t last_scan = 0;
  std::uint32_t last_segment = 0;  ///< Of `last_scan`. If less than `segment`, stored as `segment`; if greater, the trial has a gap.
  std::string result{};            ///< The event with the trial's result as JSON, see `event_of_text`; empty: no result.
  std::string recorded_outcome{};  ///< If `outcome` was corrected: as recorded. `put_trial` ignores this field.

  friend bool operator==(const TrialRow&, const TrialRow&) = default;
};

/// Returns why the trial of a result is not valid; UNSPECIFIED if it is valid, or if the event is not a result.
[[nodiscard]] v1::TrialFault fault_of(const v1::Event& result);
/// Returns true if the trial was done and its result, if it has one, has no fault.
[[nodiscard]] bool is_valid(const TrialRow& trial);

/// A marker of a recording.
struct MarkerRow {
  std::string session_id;
  std::uint32_t part = 1;
  std::uint32_t number = 1;  ///< In the recording of this part, from 1.
  std::uint32_t segment = 0;
  std::uint64_t scan = 0;
  std::string text;             ///< Empty: a person removed it.
  std::string recorded_text{};  ///< If `text` was corrected and not removed: as recorded. `put_marker` ignores this field.

  friend bool operator==(const MarkerRow&, const MarkerRow&) = default;
};

struct SessionRow {
  std::string id;
  std::string rig;  ///< The leading one.
  std::string protocol;
  std::string subject;
  std::string label;
  std::string state;  ///< "running", or how its newest parts ended: "complete", "incomplete", "interrupted", "aborted".
  std::string message;
  std::int64_t started_utc_ns = 0;
  std::int64_t ended_utc_ns = 0;  ///< 0: not ended.
  std::vector<PartRow> parts{};
  std::vector<TrialRow> trials{};
  std::string protocol_definition{};
  std::vector<MarkerRow> markers{};  ///< By part and number.
  // `subject`, `label`, the outcomes of trials and the texts of markers are the corrected ones.
  std::string recorded_subject{};
  std::string recorded_label{};
  std::string notes{};
  bool is_deleted = false;  ///< Hidden from lists.
  std::vector<Correction> corrections{};

  friend bool operator==(const SessionRow&, const SessionRow&) = default;
};

/// Returns the session's state as every program shows it. If a complete session has parts that are not complete, the state is "recovered"
/// if all of those are repaired copies, else "incomplete".
[[nodiscard]] std::string state_of(const SessionRow& session);

/// Returns all rigs of a session, the leading one first.
[[nodiscard]] std::vector<std::string> rigs_of(const SessionRow& session);
/// Returns the parts that were recorded last, at the same time.
[[nodiscard]] std::vector<PartRow> newest_parts(const SessionRow& session);
/// Returns the worse of two states of an ended session, "complete" being the best.
[[nodiscard]] std::string worse_state(const std::string& a, const std::string& b);

/// A result of a session: a steadiness measure, a trunk angle.
struct ResultRow {
  std::string session_id;
  std::string name;
  double value = 0.0;
  std::string unit;
  std::string details;  ///< JSON; may be empty.

  friend bool operator==(const ResultRow&, const ResultRow&) = default;
};

/// A recording that was found on the disk. One of a companion has no trials, results and markers: those of its session are in the
/// recording of the leading rig.
struct FoundRecording {
  SessionFacts facts{};
  PartRow part{};  ///< Names the same session and part as `facts`.
  std::vector<TrialRow> trials{};
  std::vector<ResultRow> results{};
  std::vector<MarkerRow> markers{};
  std::map<std::uint32_t, std::uint32_t> begun_attempts{};  ///< Newest attempt of each trial that has begun.
  std::string session_state;                                ///< State of the session if this is one of its newest parts.
  std::int64_t ended_utc_ns = 0;
};

/// A part whose recording begins.
struct NewPart {
  SessionFacts facts{};
  std::string file;
};

enum class Shown : std::uint8_t { Kept = 1, Deleted, Both };

struct SessionFilter {
  std::string rig{};  ///< Empty: all; leading or not.
  std::string subject{};
  std::string protocol{};
  std::size_t limit = 100;  ///< Most sessions to return, newest first; at most 10,000.
  Shown shown = Shown::Kept;
};

/// A subject and the sum of its sessions, deleted ones included.
struct SubjectRow {
  std::string subject;
  std::uint32_t sessions = 0;
  std::uint32_t deleted_sessions = 0;
  std::int64_t first_utc_ns = 0;  ///< Starts of the oldest and the newest session, without deleted ones; 0: none.
  std::int64_t last_utc_ns = 0;
  std::uint64_t bytes = 0;
  std::vector<std::string> rigs{};  ///< Leading rigs of its sessions, sorted.

  friend bool operator==(const SubjectRow&, const SubjectRow&) = default;
};

struct SubjectFilter {
  std::string subject{};       ///< Empty: all.
  std::size_t limit = 10'000;  ///< Most subjects to return.
};

/// The index of all recordings: an SQLite database (WAL, synchronous = FULL) in the state folder. If a file and the catalogue differ, the
/// file is right. Everything except the audit trail can be rebuilt from the files. `open` migrates older schema versions and rejects newer
/// ones. Thread: control.
class Catalogue {
 public:
  /// Opens the catalogue, or creates it with mode 0640. Fails with DataDamaged if the file is no database or a damaged one
  /// (Recordings::open sets it aside), with WrongState if it is a database of another program, with Unsupported if a newer version made it,
  /// and with NotFound, NotAllowed or Failed if the folder does not exist, cannot be written or is full.
  [[nodiscard]] static core::Result<std::unique_ptr<Catalogue>> open(const std::string& file);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;
  Catalogue(Catalogue&&) = delete;
  Catalogue& operator=(Catalogue&&) = delete;

  /// Adds a new session with its first part, or a further part to a known session, which then is "running" again. Adds the subject, the
  /// protocol and the calibration too. Fails with WrongState if the part is known, or if the known session has another leading rig, subject
  /// or protocol.
  [[nodiscard]] core::Status begin_part(const SessionFacts& facts, const std::string& file);
  /// Adds parts that begin at the same time, completely or not at all. Fails like `begin_part`.
  [[nodiscard]] core::Status begin_parts(const std::vector<NewPart>& parts);
  /// Updates all fields of a part except when it started. Fails with NotFound if there is no such part.
  [[nodiscard]] core::Status update_part(const PartRow& part);
  /// Ends a session. Fails with NotFound if there is no such session, and with InvalidArgument if `state` is not the state of an ended one.
  [[nodiscard]] core::Status end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns);
  /// Notes that this attempt and all before it have begun: their numbers are not used again, however the attempts end. Fails with NotFound
  /// if there is no such session.
  [[nodiscard]] core::Status begin_attempt(const std::string& session_id, std::uint32_t trial, std::uint32_t attempt);
  /// Adds a trial, or replaces the row of the same trial and attempt. Fails with NotFound if there is no such part.
  [[nodiscard]] core::Status put_trial(const TrialRow& trial);
  /// Removes the row of this part, trial and attempt, if there is one: the trial is under way again.
  [[nodiscard]] core::Status remove_trial(const TrialRow& trial);
  /// Adds a marker, or replaces the one of the same part and number. Fails with NotFound if there is no such part.
  [[nodiscard]] core::Status put_marker(const MarkerRow& marker);
  [[nodiscard]] core::Status put_calibration(const std::string& id, const std::string& rig, const std::string& kind,
                                             const std::string& text);
  /// Adds a result, or replaces the result of the same name. Fails with NotFound if there is no such session, and with InvalidArgument if
  /// the value is not finite.
  [[nodiscard]] core::Status put_result(const ResultRow& result);
  /// Adds a recording completely or not at all. If the part is known, replaces its row, its trials and its markers by those of the file.
  /// Changes the session's state only if this part is newer than all known parts, or recorded at the same time as the newest: then to the
  /// worse of both. The corrections of the session stay.
  [[nodiscard]] core::Status enter(const FoundRecording& found);
  /// Replaces the markers of a known part and adds its attempts, completely or not at all; ignores the other rows. Fails with NotFound if
  /// there is no such part.
  [[nodiscard]] core::Status enter_events(const FoundRecording& found);

  /// Replaces all corrections of a session, sets its values accordingly and replaces its results if some are given, completely or not at
  /// all. A text that a correction removed is not kept. Fails with NotFound if there is no such session, and like `set_results`.
  [[nodiscard]] core::Status set_corrections(const Corrections& corrections,
                                             const std::optional<std::vector<ResultRow>>& results = std::nullopt);
  /// Replaces all results of a session, completely or not at all. Fails like `put_result`.
  [[nodiscard]] core::Status set_results(const std::string& session_id, const std::vector<ResultRow>& results);
  /// Removes all rows of sessions, and subjects without a session, completely or not at all. Unknown sessions are ignored.
  [[nodiscard]] core::Status erase(const std::vector<std::string>& session_ids);
  /// Sets how long a call waits while another connection writes. Default: 1 s.
  void wait_at_most(std::chrono::milliseconds time) const;
  /// Writes the whole database of a catalogue again and empties its log, so that no bytes of removed rows remain. Returns false if another
  /// program that reads the catalogue prevents it: the log then still has them. Uses a connection of its own; others can read meanwhile,
  /// but not write. Needs the catalogue's size twice on its disk; a copy without the removed rows is in `folder` while it runs. Fails early
  /// if `is_wanted` returns false. Thread: any.
  [[nodiscard]] static core::Result<bool> overwrite_removed(const std::string& file, const std::string& folder,
                                                            const std::function<bool()>& is_wanted);

  [[nodiscard]] core::Result<std::vector<SubjectRow>> subjects(const SubjectFilter& filter = {}) const;  ///< Sorted.
  [[nodiscard]] core::Result<std::size_t> count_subjects() const;
  /// Returns the sessions that have corrections.
  [[nodiscard]] core::Result<std::vector<Corrections>> corrections() const;
  [[nodiscard]] core::Result<std::vector<SessionRow>> sessions(
      const SessionFilter& filter) const;                                       ///< With parts and corrections, without trials and markers.
  [[nodiscard]] core::Result<SessionRow> session(const std::string& id) const;  ///< With all rows. Fails with NotFound.
  /// Returns a session without its parts and trials. Fails with NotFound.
  [[nodiscard]] core::Result<SessionRow> session_texts(const std::string& id) const;
  /// Returns the IDs of all sessions whose recorded subject ID, recorded label, markers or corrections contain this subject ID, sorted;
  /// without the sessions of this subject.
  [[nodiscard]] core::Result<std::vector<std::string>> sessions_with(const std::string& subject) const;
  [[nodiscard]] core::Result<std::vector<ResultRow>> results(const std::string& session_id) const;
  /// Returns the newest attempt of each trial that has begun, in any part of the session.
  [[nodiscard]] core::Result<std::map<std::uint32_t, std::uint32_t>> newest_attempts(const std::string& session_id) const;
  /// Returns the parts in the state Recording. When the daemon starts, these are the interrupted ones.
  [[nodiscard]] core::Result<std::vector<PartRow>> unfinished_parts() const;
  [[nodiscard]] core::Result<std::vector<PartRow>> parts() const;  ///< All, sorted by session ID.
  /// Returns the session ID and the number of the parts whose markers and attempts are not entered: an older version added them.
  [[nodiscard]] core::Result<std::set<std::pair<std::string, std::uint32_t>>> parts_without_events() const;

  /// Appends an entry. Sets `number` and `hash`; cuts texts longer than 1 KiB.
  [[nodiscard]] core::Status append_audit(AuditEntry entry);
  [[nodiscard]] core::Result<std::vector<AuditEntry>> audit(std::size_t newest) const;  ///< Oldest first; at most 10,000.
  /// Recomputes the whole chain, compares it with the second trail and returns the number of entries. Fails with DataDamaged, naming the
  /// first entry that does not match.
  [[nodiscard]] core::Result<std::uint64_t> verify_audit() const;

 private:
  class Implementation;
  explicit Catalogue(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// Returns everything that `Catalogue::enter` needs of a recording: its state, trials and results. Reads the whole file twice. Thread: any.
[[nodiscard]] core::Result<FoundRecording> read_recording(const std::string& file);

/// Return the state of a recording file, and why it is not complete. The catalogue, `session verify` and the report use the same words.
[[nodiscard]] PartState state_of(const Verification& verified, const std::string& file);
[[nodiscard]] std::string reason_of(const Verification& verified, const std::string& file);

struct Rebuilt {
  std::size_t added = 0;                ///< Parts that the catalogue did not know.
  std::size_t missing = 0;              ///< Parts whose file does not exist any more.
  std::vector<std::string> unreadable;  ///< "file: why"
  std::size_t read_again = 0;           ///< Parts whose losses, markers or attempts the catalogue did not know.
  std::size_t found_again = 0;          ///< Parts whose file was missing or elsewhere, or that now have a repaired copy.
};
/// Adds every recording (*.xdf, *.xdf.part) in `folder` and its subfolders that the catalogue does not know, with its trials. Marks parts
/// whose file does not exist any more as Missing. Identifies a recording by the facts in its header, not by its file name. If one part has
/// several files, uses the closed one, or else the repaired copy. Adds a recording without footers as Interrupted. Reads the headers of
/// files whose path the catalogue does not know, and the whole file if it adds the recording or lacks its losses, markers or attempts. Then
/// reads the corrections beside the recordings: if file and catalogue differ, the longer list is right, because corrections are only added.
/// A file elsewhere (a copied folder) counts only if it is longer than all of these. Writes a file that is missing; a failure is listed in
/// `unreadable`. Removes files of corrections that a crash left unfinished. Fails with NotFound, and marks no part, if the folder does not
/// exist.
[[nodiscard]] core::Result<Rebuilt> rebuild(Catalogue& catalogue, const std::string& folder);

}  // namespace dts::record
