// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/losses.h"
#include "core/result.h"
#include "record/session_facts.h"
#include "record/xdf/recovery.h"

namespace dts::record {

/// How far a recording came. Everything but Complete is shown as what it is, everywhere.
enum class PartState : std::uint8_t {
  Recording = 1,  ///< Being written. Found at start: the daemon died, see `Interrupted`.
  Complete,
  Incomplete,   ///< Closed, but something is missing: write error, disk full, scans that found no room.
  Interrupted,  ///< The daemon or the power died while writing; no repaired copy yet.
  Recovered,    ///< The same, with a repaired copy.
  Missing,      ///< The file is gone.
};
[[nodiscard]] std::string_view name(PartState state) noexcept;

/// One file of a session.
struct PartRow {
  std::string session_id;
  std::uint32_t part = 1;
  std::string file;  ///< Path; of the repaired copy once there is one.
  PartState state = PartState::Recording;
  std::string sha256;  ///< Empty until closed.
  std::uint64_t bytes = 0;
  std::uint64_t scans = 0;
  double duration_s = 0.0;      ///< From the first scan to the end of the last, gaps included.
  /// Between the two. Absent: not known, because the recording is not closed yet or its file could not be read.
  std::optional<core::Losses> losses{};
  double lost_s_at_most = 0.0;  ///< Behind the last, of a recovered recording.
  std::string reason;           ///< Why it is not complete.
  std::int64_t started_utc_ns = 0;
  std::uint32_t valid_trials = 0;  ///< Counted by the catalogue, from the part's trials; `update_part` ignores it.

  friend bool operator==(const PartRow&, const PartRow&) = default;
};

struct TrialRow {
  std::string session_id;
  std::uint32_t part = 1;
  std::uint32_t trial = 0;  ///< Place in the plan, from 1.
  std::uint32_t attempt = 1;
  std::uint32_t block = 1;
  std::string condition;
  std::string outcome;           ///< "done", "redone", "rejected", "aborted"
  std::uint32_t segment = 0;     ///< Of `first_scan`.
  std::uint64_t first_scan = 0;  ///< Where it begins to count; where it began, if it never came so far.
  std::uint64_t last_scan = 0;
  std::uint32_t last_segment = 0;  ///< Of `last_scan`. Stored as `segment` when it is less; more: a gap lies within the trial.
  std::string result{};            ///< What came of it: the event "result" or "sway" as JSON; empty: nothing.

  friend bool operator==(const TrialRow&, const TrialRow&) = default;
};

/// Whether a trial counts: it was done, and its steadiness result, if it has one, is valid.
[[nodiscard]] bool is_valid(const TrialRow& trial);

struct SessionRow {
  std::string id;
  std::string rig;
  std::string protocol;
  std::string subject;
  std::string label;
  std::string state;  ///< "running", "complete", "incomplete", "interrupted", "aborted": how its newest part ended.
  std::string message;
  std::int64_t started_utc_ns = 0;
  std::int64_t ended_utc_ns = 0;  ///< 0: not ended.
  std::vector<PartRow> parts{};
  std::vector<TrialRow> trials{};
  std::string protocol_definition{};

  friend bool operator==(const SessionRow&, const SessionRow&) = default;
};

/// The one word that every program shows for a session: its state. A complete session of which not every part is complete is "recovered"
/// when the others are repaired copies, else "incomplete".
[[nodiscard]] std::string state_of(const SessionRow& session);

/// A figure that came out of a session: a steadiness measure, a trunk angle.
struct ResultRow {
  std::string session_id;
  std::string name;
  double value = 0.0;
  std::string unit;
  std::string details;  ///< JSON; may be empty.
};

/// A recording that was found on the disk.
struct FoundRecording {
  SessionFacts facts{};
  PartRow part{};  ///< Names the same session and part as `facts`.
  std::vector<TrialRow> trials{};
  std::vector<ResultRow> results{};
  std::string session_state;  ///< What the session is when this is its newest part.
  std::int64_t ended_utc_ns = 0;
};

struct SessionFilter {
  std::string rig{};  ///< Empty: all.
  std::string subject{};
  std::string protocol{};
  std::size_t limit = 100;  ///< Newest first; at most 10,000.
};

/// One entry of the audit trail. `hash` is SHA-256 over the one before and this one's fields: an entry that was changed, removed or put in
/// shows. What shows and what does not: audit_trail.h.
struct AuditEntry {
  std::uint64_t number = 0;  ///< From 1, without holes.
  std::int64_t utc_ns = 0;
  std::string who;     ///< "local", later the name of a key.
  std::string what;    ///< "start_session"
  std::string target;  ///< "floor", a session's id
  std::string result;  ///< "ok", or the error code's name
  std::string hash;

  friend bool operator==(const AuditEntry&, const AuditEntry&) = default;
};

/// The index of everything recorded: SQLite (WAL, synchronous = FULL) in the state folder. The files are the truth, this is how one finds
/// them: it can be rebuilt from them, all but the audit trail. Schema versions migrate forward when it is opened; one of a
/// newer program is refused. Thread: control.
class Catalogue {
 public:
  /// Opens or creates. DataDamaged: no database, or a damaged one (Recordings::open sets it aside). WrongState: another program's database.
  /// Unsupported: made by a newer version.
  /// Creates with mode 0640. NotFound, NotAllowed, Failed: the folder is not there, cannot be written, or is full.
  [[nodiscard]] static core::Result<std::unique_ptr<Catalogue>> open(const std::string& file);
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;
  Catalogue(Catalogue&&) = delete;
  Catalogue& operator=(Catalogue&&) = delete;

  /// A new session with its first part, or a further part of a known one, which is running again; the subject, the protocol and the
  /// calibration are entered too. WrongState: the part is known already, or the session is one of another rig, subject or protocol.
  [[nodiscard]] core::Status begin_part(const SessionFacts& facts, const std::string& file);
  /// All but when it started. NotFound when there is no such part.
  [[nodiscard]] core::Status update_part(const PartRow& part);
  /// NotFound when there is no such session; InvalidArgument for any state but those of an ended one.
  [[nodiscard]] core::Status end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns);
  /// Replaces the row of the same trial and attempt. NotFound when there is no such part.
  [[nodiscard]] core::Status put_trial(const TrialRow& trial);
  [[nodiscard]] core::Status put_calibration(const std::string& id, const std::string& rig, const std::string& kind,
                                             const std::string& text);
  /// Replaces the one of the same name. NotFound when there is no such session; InvalidArgument when the value is not finite.
  [[nodiscard]] core::Status put_result(const ResultRow& result);
  /// Enters it whole or not at all: a part that is new, or a known one with its new place and its trials as they stand in the file. How the
  /// session stands changes only when this is its newest part, and a new one.
  [[nodiscard]] core::Status enter(const FoundRecording& found);

  [[nodiscard]] core::Result<std::vector<SessionRow>> sessions(const SessionFilter& filter) const;  ///< With parts, without trials.
  [[nodiscard]] core::Result<SessionRow> session(const std::string& id) const;                      ///< With all. NotFound.
  [[nodiscard]] core::Result<std::vector<ResultRow>> results(const std::string& session_id) const;
  /// Parts that are being written, as far as the catalogue knows: at start these were interrupted.
  [[nodiscard]] core::Result<std::vector<PartRow>> unfinished_parts() const;
  [[nodiscard]] core::Result<std::vector<PartRow>> parts() const;  ///< All, in the order of sessions' ids.

  /// Appends; `number` and `hash` are made here, texts longer than 1 KiB are cut.
  [[nodiscard]] core::Status append_audit(AuditEntry entry);
  [[nodiscard]] core::Result<std::vector<AuditEntry>> audit(std::size_t newest) const;  ///< Oldest first; at most 10,000.
  /// Recomputes the whole chain and compares it with the second trail; DataDamaged names the first entry that does not fit. Returns the
  /// number of entries.
  [[nodiscard]] core::Result<std::uint64_t> verify_audit() const;

 private:
  class Implementation;
  explicit Catalogue(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

/// All that a recording says of itself, for `Catalogue::enter`: how it stands, and its trials. Reads the whole file, twice. Thread: any.
[[nodiscard]] core::Result<FoundRecording> read_recording(const std::string& file);

/// How a recording stands by itself, and why it is not complete: the same words in the catalogue, `session verify` and the report.
[[nodiscard]] PartState state_of(const Verification& verified, const std::string& file);
[[nodiscard]] std::string reason_of(const Verification& verified, const std::string& file);

struct Rebuilt {
  std::size_t added = 0;                ///< Parts that the catalogue did not know.
  std::size_t missing = 0;              ///< Parts whose file is gone.
  std::vector<std::string> unreadable;  ///< "file: why"
  std::size_t read_again = 0;           ///< Parts whose losses the catalogue did not know.
  std::size_t found_again = 0;          ///< Parts whose file was gone or elsewhere, or that have a repaired copy now.
};
/// Enters every recording of `folder` and the folders in it (*.xdf, *.xdf.part) that the catalogue does not know, with its trials, and
/// marks parts whose file is gone. Knows recordings by the facts in their header, not by their names; of several files of one part the
/// closed one counts, then the repaired copy. A recording without footers is entered as Interrupted. Reads the headers of files whose place
/// the catalogue does not know, and the whole of those that it enters or whose losses are not known. NotFound: there is no folder, nothing
/// is marked.
[[nodiscard]] core::Result<Rebuilt> rebuild(Catalogue& catalogue, const std::string& folder);

}  // namespace dts::record
