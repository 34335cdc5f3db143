// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/catalogue.h"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "record/catalogue/audit_trail.h"
#include "record/catalogue/catalogue_rows.h"
#include "record/catalogue/schema.h"
#include "record/catalogue/sqlite.h"
#include "record/losses.h"
#include "record/sha256.h"

namespace dts::record {
namespace {

using core::ErrorCode;

constexpr std::size_t kLongestId = 128;
constexpr std::size_t kMostSessions = 10'000;
constexpr std::chrono::milliseconds kLongestWait{1000};  // for another program, while removed rows are overwritten
constexpr std::array<std::string_view, 4> kEndStates{"complete", "incomplete", "interrupted", "aborted"};

tl::unexpected<core::Error> no_session(const std::string& id) {
  return core::fail(ErrorCode::NotFound, "no session " + id.substr(0, kLongestId), "see dtsctl session list");
}
tl::unexpected<core::Error> no_part(const std::string& id, std::uint32_t part) {
  return core::fail(ErrorCode::NotFound, "no part " + std::to_string(part) + " of session " + id.substr(0, kLongestId));
}

/// Checks the session ID strictly, because it becomes part of file names.
core::Status check_facts(const SessionFacts& facts) {
  if (facts.session_id.empty() || facts.session_id.size() > kLongestId || !is_id(facts.session_id)) {
    return core::fail(ErrorCode::InvalidArgument, "a session's id is not 1 to 128 letters, digits, '_', '.' or '-'");
  }
  if (facts.part == 0 || facts.rig.empty() || leading_rig(facts).empty()) {
    return core::fail(ErrorCode::InvalidArgument, "session " + facts.session_id + " names no rig, or part 0");
  }
  return {};
}

/// Rounds to 1 us: the writer of a file and its readers compute the same duration with smaller rounding differences.
double whole_microseconds(double time_s) noexcept { return std::round(time_s * 1e6) / 1e6; }

}  // namespace

std::string_view name(PartState state) noexcept {
  switch (state) {
    case PartState::Recording: return "recording";
    case PartState::Complete: return "complete";
    case PartState::Incomplete: return "incomplete";
    case PartState::Interrupted: return "interrupted";
    case PartState::Recovered: return "recovered";
    case PartState::Missing: return "missing";
  }
  return "unknown";
}

class Catalogue::Implementation {
 public:
  explicit Implementation(Database opened) : database(std::move(opened)), audit(database) {}

  [[nodiscard]] core::Status enter_session(const SessionFacts& facts) const;
  void enter_part(const SessionFacts& facts, const std::string& file) const;
  void put_calibration(const std::string& id, const std::string& rig, const std::string& kind, const std::string& text) const;
  [[nodiscard]] bool has_part(const std::string& id, std::uint32_t part) const {
    return database.query("SELECT 1 FROM parts WHERE session_id = ? AND part = ?", id, part).step();
  }
  [[nodiscard]] std::vector<Correction> corrections_of(const std::string& id) const {
    return rows_of(database.query(std::string(kCorrectionColumns) + "WHERE session_id = ? ORDER BY number", id), read_correction);
  }
  [[nodiscard]] std::vector<TrialRow> trials_of(const std::string& id) const {
    return rows_of(database.query(std::string(kTrialColumns) + "WHERE session_id = ? ORDER BY part, trial, attempt", id), read_trial);
  }
  [[nodiscard]] std::vector<MarkerRow> markers_of(const std::string& id, const Corrections& corrections) const;
  void apply(const Corrections& corrections) const;
  void decide_valid_trials() const;
  [[nodiscard]] std::vector<PartRow> parts_of(const std::string& id) const {
    return rows_of(database.query(std::string(kPartColumns) + "WHERE session_id = ? ORDER BY part", id), read_part);
  }

  Database database;
  AuditTrail audit;
};

/// Returns the markers with their corrected texts.
std::vector<MarkerRow> Catalogue::Implementation::markers_of(const std::string& id, const Corrections& corrections) const {
  auto markers = rows_of(database.query(std::string(kMarkerColumns) + "WHERE session_id = ? ORDER BY part, number", id), read_marker);
  for (MarkerRow& marker : markers) {
    const std::string* const text = corrections.marker(marker.part, marker.number);
    if (text == nullptr || *text == marker.text) continue;
    marker.recorded_text = std::exchange(marker.text, *text);
  }
  return markers;
}

/// Adds the protocol and the subject, then adds the session or sets a known one to "running".
core::Status Catalogue::Implementation::enter_session(const SessionFacts& facts) const {
  const std::string protocol_sha256 = sha256_of(facts.protocol_definition);
  database.run("INSERT OR IGNORE INTO protocols (name, sha256, definition) VALUES (?, ?, ?)", facts.protocol, protocol_sha256,
               facts.protocol_definition);
  if (!facts.subject.empty()) database.run("INSERT OR IGNORE INTO subjects (pseudonym) VALUES (?)", facts.subject);
  const auto known = rows_of(database.query(std::string(kSessionColumns) + "WHERE sessions.id = ?", facts.session_id), read_session);
  if (known.empty()) {
    database.run(
        "INSERT INTO sessions (id, rig, protocol_id, subject_id, label, state, message, started_utc_ns, ended_utc_ns) VALUES (?, ?,"
        " (SELECT id FROM protocols WHERE name = ? AND sha256 = ?), (SELECT id FROM subjects WHERE pseudonym = ?), ?, 'running', '', ?, 0)",
        facts.session_id, leading_rig(facts), facts.protocol, protocol_sha256, facts.subject, facts.label, facts.started_utc_ns);
    return {};
  }
  const SessionRow& session = known.front();
  if (session.rig != leading_rig(facts) || session.protocol != facts.protocol || session.recorded_subject != facts.subject) {
    return core::fail(ErrorCode::WrongState, "session " + facts.session_id + " is known with another rig, protocol or subject");
  }
  database.run(
      "UPDATE sessions SET state = 'running', message = '', ended_utc_ns = 0, started_utc_ns = min(started_utc_ns, ?) WHERE id = ?",
      facts.started_utc_ns, facts.session_id);
  return {};
}

void Catalogue::Implementation::enter_part(const SessionFacts& facts, const std::string& file) const {
  if (!facts.calibration_id.empty()) put_calibration(facts.calibration_id, facts.rig, "cop", facts.rig_definition);
  database.run(
      "INSERT INTO parts (session_id, part, file, state, sha256, bytes, scans, duration_s, lost_s_at_most, reason, started_utc_ns,"
      " calibration_id, losses, has_events, rig, leading_part) VALUES (?, ?, ?, ?, '', 0, 0, 0, 0, '', ?, ?, '', 1, ?, ?)",
      facts.session_id, facts.part, file, static_cast<int>(PartState::Recording), facts.started_utc_ns, facts.calibration_id, facts.rig,
      leading_part(facts));
}

/// Sets the values of a session and its trials as its corrections say.
void Catalogue::Implementation::apply(const Corrections& corrections) const {
  const std::string& id = corrections.session_id;
  database.run("UPDATE sessions SET corrected_subject = NULL, corrected_label = NULL, notes = '', is_deleted = 0 WHERE id = ?", id);
  if (const std::string* subject = corrections.value(CorrectedField::Subject)) {
    database.run("UPDATE sessions SET corrected_subject = ? WHERE id = ?", *subject, id);
  }
  if (const std::string* label = corrections.value(CorrectedField::Label)) {
    database.run("UPDATE sessions SET corrected_label = ? WHERE id = ?", *label, id);
  }
  if (corrections.has_removed(CorrectedField::Label)) database.run("UPDATE sessions SET label = '' WHERE id = ?", id);
  if (const std::string* notes = corrections.value(CorrectedField::Notes)) {
    database.run("UPDATE sessions SET notes = ? WHERE id = ?", *notes, id);
  }
  if (const std::string* deleted = corrections.value(CorrectedField::Deleted)) {
    database.run("UPDATE sessions SET is_deleted = ? WHERE id = ?", *deleted == "yes" ? 1 : 0, id);
  }
  for (const Correction& one : corrections.all) {
    if (one.field != CorrectedField::Marker || !corrections.has_removed_marker(one.part, one.marker)) continue;
    database.run("UPDATE markers SET text = '' WHERE session_id = ? AND part = ? AND number = ?", id, one.part, one.marker);
  }
  for (TrialRow trial : trials_of(id)) {
    const std::string recorded = trial.recorded_outcome.empty() ? trial.outcome : trial.recorded_outcome;
    const std::string* const outcome = corrections.outcome(trial.part, trial.trial, trial.attempt);
    const bool is_corrected = outcome != nullptr && *outcome != recorded;
    if (!is_corrected && trial.recorded_outcome.empty()) continue;
    trial.outcome = is_corrected ? *outcome : recorded;
    database.run(
        "UPDATE trials SET corrected_outcome = NULLIF(?, ''), is_valid = ? WHERE session_id = ? AND part = ? AND trial = ? AND attempt = ?",
        is_corrected ? trial.outcome : std::string(), is_valid(trial) ? 1 : 0, id, trial.part, trial.trial, trial.attempt);
  }
}

/// Decides which trials are valid, where a migration has left it open. One session at a time: the results of all trials may be large.
void Catalogue::Implementation::decide_valid_trials() const {
  const auto undecided = rows_of(database.query("SELECT DISTINCT session_id FROM trials WHERE is_valid IS NULL"),
                                 [](const Statement& row) { return row.text(0); });
  for (const std::string& id : undecided) {
    Transaction transaction(database);
    for (const TrialRow& trial : trials_of(id)) {
      database.run("UPDATE trials SET is_valid = ? WHERE session_id = ? AND part = ? AND trial = ? AND attempt = ?",
                   is_valid(trial) ? 1 : 0, id, trial.part, trial.trial, trial.attempt);
    }
    transaction.commit();
  }
}

Catalogue::Catalogue(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
Catalogue::~Catalogue() = default;

core::Result<std::unique_ptr<Catalogue>> Catalogue::open(const std::string& file) {
  DTS_TRY_ASSIGN(auto database, Database::open(file));
  DTS_TRY(migrate(database, catalogue_migrations()));
  auto implementation = std::make_unique<Implementation>(std::move(database));
  // After the migration, so that a database of another program is not changed.
  try {
    implementation->database.execute("PRAGMA journal_mode = WAL");
    implementation->decide_valid_trials();
  } catch (const SQLite::Exception& exception) {
    return implementation->database.failure(exception);
  }
  return std::unique_ptr<Catalogue>(new Catalogue(std::move(implementation)));
}

core::Status Catalogue::begin_part(const SessionFacts& facts, const std::string& file) try {
  if (auto good = check_facts(facts); !good) return good;
  Transaction transaction(implementation_->database);
  if (implementation_->has_part(facts.session_id, facts.part)) {
    return core::fail(ErrorCode::WrongState,
                      "part " + std::to_string(facts.part) + " of session " + facts.session_id + " is known already");
  }
  if (auto entered = implementation_->enter_session(facts); !entered) return entered;
  implementation_->enter_part(facts, file);
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::begin_parts(const std::vector<NewPart>& parts) try {
  Transaction transaction(implementation_->database);
  for (const NewPart& part : parts) DTS_TRY(begin_part(part.facts, part.file));
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::update_part(const PartRow& part) try {
  if (!std::isfinite(part.duration_s) || !std::isfinite(part.lost_s_at_most)) {
    return core::fail(ErrorCode::InvalidArgument, "duration or loss of a recording is no number");
  }
  implementation_->database.run(
      "UPDATE parts SET file = ?, state = ?, sha256 = ?, bytes = ?, scans = ?, duration_s = ?, lost_s_at_most = ?, reason = ?, losses = ?"
      " WHERE session_id = ? AND part = ?",
      part.file, static_cast<int>(part.state), part.sha256, part.bytes, part.scans, whole_microseconds(part.duration_s),
      part.lost_s_at_most, part.reason, part.losses ? to_json(*part.losses) : std::string(), part.session_id, part.part);
  if (implementation_->database.changes() == 0) return no_part(part.session_id, part.part);
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns) try {
  if (std::ranges::find(kEndStates, state) == kEndStates.end()) {
    return core::fail(ErrorCode::InvalidArgument, "a session cannot end as '" + state.substr(0, kLongestId) + "'");
  }
  implementation_->database.run("UPDATE sessions SET state = ?, message = ?, ended_utc_ns = ? WHERE id = ?", state, message, utc_ns, id);
  if (implementation_->database.changes() == 0) return no_session(id);
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::begin_attempt(const std::string& session_id, std::uint32_t trial, std::uint32_t attempt) try {
  const Database& database = implementation_->database;
  Transaction transaction(database);
  if (!database.query("SELECT 1 FROM sessions WHERE id = ?", session_id).step()) return no_session(session_id);
  database.run(
      "INSERT INTO begun_attempts (session_id, trial, newest) VALUES (?, ?, ?)"
      " ON CONFLICT (session_id, trial) DO UPDATE SET newest = max(newest, excluded.newest)",
      session_id, trial, attempt);
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::map<std::uint32_t, std::uint32_t>> Catalogue::newest_attempts(const std::string& session_id) const try {
  auto rows = implementation_->database.query(
      "SELECT trial, max(attempt) FROM (SELECT trial, attempt FROM trials WHERE session_id = ?1"
      " UNION ALL SELECT trial, newest FROM begun_attempts WHERE session_id = ?1) GROUP BY trial",
      session_id);
  std::map<std::uint32_t, std::uint32_t> newest;
  while (rows.step()) newest.emplace(rows.count32(0), rows.count32(1));
  return newest;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::put_trial(const TrialRow& trial) try {
  if (std::ranges::find(kTrialOutcomes, trial.outcome) == kTrialOutcomes.end() || trial.trial == 0 || trial.attempt == 0) {
    return core::fail(ErrorCode::InvalidArgument,
                      "a trial has a number, an attempt and one of the outcomes done, redone, rejected, aborted");
  }
  Transaction transaction(implementation_->database);
  if (!implementation_->has_part(trial.session_id, trial.part)) return no_part(trial.session_id, trial.part);
  implementation_->database.run(
      "INSERT OR REPLACE INTO trials (session_id, part, trial, attempt, block, condition, outcome, segment, first_scan, last_scan,"
      " last_segment, result, is_valid) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      trial.session_id, trial.part, trial.trial, trial.attempt, trial.block, trial.condition, trial.outcome, trial.segment,
      trial.first_scan, trial.last_scan, std::max(trial.segment, trial.last_segment), trial.result, is_valid(trial) ? 1 : 0);
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::put_marker(const MarkerRow& marker) try {
  const Database& database = implementation_->database;
  Transaction transaction(database);
  if (!implementation_->has_part(marker.session_id, marker.part)) return no_part(marker.session_id, marker.part);
  database.run("INSERT OR REPLACE INTO markers (session_id, part, number, segment, scan, text) VALUES (?, ?, ?, ?, ?, ?)",
               marker.session_id, marker.part, marker.number, marker.segment, marker.scan, marker.text);
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::remove_trial(const TrialRow& trial) try {
  implementation_->database.run("DELETE FROM trials WHERE session_id = ? AND part = ? AND trial = ? AND attempt = ?", trial.session_id,
                                trial.part, trial.trial, trial.attempt);
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::put_calibration(const std::string& id, const std::string& rig, const std::string& kind,
                                        const std::string& text) try {
  implementation_->put_calibration(id, rig, kind, text);
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

void Catalogue::Implementation::put_calibration(const std::string& id, const std::string& rig, const std::string& kind,
                                                const std::string& text) const {
  database.run("INSERT OR REPLACE INTO calibrations (id, rig, kind, definition) VALUES (?, ?, ?, ?)", id, rig, kind, text);
}

core::Status Catalogue::put_result(const ResultRow& result) try {
  if (!std::isfinite(result.value)) return core::fail(ErrorCode::InvalidArgument, "result '" + result.name + "' is no number");
  const Database& database = implementation_->database;
  Transaction transaction(database);
  if (!database.query("SELECT 1 FROM sessions WHERE id = ?", result.session_id).step()) return no_session(result.session_id);
  database.run("INSERT OR REPLACE INTO results (session_id, name, value, unit, details) VALUES (?, ?, ?, ?, ?)", result.session_id,
               result.name, result.value, result.unit, result.details);
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::enter(const FoundRecording& found) try {
  Transaction transaction(implementation_->database);
  const auto before = session(found.facts.session_id);
  if (!before && before.error().code != ErrorCode::NotFound) return tl::make_unexpected(before.error());
  const std::vector<PartRow> newest = before ? newest_parts(*before) : std::vector<PartRow>{};
  const bool is_newest = newest.empty() || newest.front().leading_part < leading_part(found.facts);
  const bool is_known = implementation_->has_part(found.facts.session_id, found.facts.part);
  core::Status done;
  if (!is_known) done = begin_part(found.facts, found.part.file);
  if (done) done = update_part(found.part);
  if (done) {
    implementation_->database.run("DELETE FROM trials WHERE session_id = ? AND part = ?", found.part.session_id, found.part.part);
  }
  for (const TrialRow& trial : found.trials) {
    if (done) done = put_trial(trial);
  }
  if (done) done = enter_events(found);
  for (const ResultRow& result : found.results) {
    if (done) done = put_result(result);  // results belong to the session, not to a part
  }
  if (done && is_newest) {
    done = end_session(found.facts.session_id, found.session_state, found.part.reason, found.ended_utc_ns);
  } else if (done && before->state != "running" && !is_known && newest.front().leading_part == leading_part(found.facts)) {
    const std::string& reason = before->message.empty() ? found.part.reason : before->message;
    done = end_session(before->id, worse_state(before->state, found.session_state), reason,
                       std::max(before->ended_utc_ns, found.ended_utc_ns));
  } else if (done && before->state != "running") {  // an older part was added: `begin_part` set the state to "running"
    done = end_session(before->id, before->state, before->message, before->ended_utc_ns);
  }
  if (done) transaction.commit();
  return done;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::enter_events(const FoundRecording& found) try {
  const std::string& id = found.part.session_id;
  const Database& database = implementation_->database;
  Transaction transaction(database);
  database.run("UPDATE parts SET has_events = 1 WHERE session_id = ? AND part = ?", id, found.part.part);
  if (database.changes() == 0) return no_part(id, found.part.part);
  database.run("DELETE FROM markers WHERE session_id = ? AND part = ?", id, found.part.part);
  for (const MarkerRow& marker : found.markers) DTS_TRY(put_marker(marker));
  for (const auto& [trial, attempt] : found.begun_attempts) DTS_TRY(begin_attempt(id, trial, attempt));
  implementation_->apply({id, implementation_->corrections_of(id)});
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<SessionRow>> Catalogue::sessions(const SessionFilter& filter) const try {
  auto found = rows_of(implementation_->database.query(std::string(kSessionColumns) +
                                                           "WHERE (?1 = '' OR sessions.rig = ?1 OR EXISTS"
                                                           " (SELECT 1 FROM parts WHERE session_id = sessions.id AND parts.rig = ?1)) AND"
                                                           " (?2 = '' OR shown_subject = ?2) AND"
                                                           " (?3 = '' OR protocols.name = ?3) AND sessions.is_deleted BETWEEN ?5 AND ?6"
                                                           " ORDER BY sessions.started_utc_ns DESC, sessions.id DESC LIMIT ?4",
                                                       filter.rig, filter.subject, filter.protocol, std::min(filter.limit, kMostSessions),
                                                       filter.shown == Shown::Deleted ? 1 : 0, filter.shown == Shown::Kept ? 0 : 1),
                       read_session);
  for (SessionRow& session : found) {
    session.parts = implementation_->parts_of(session.id);
    session.corrections = implementation_->corrections_of(session.id);
  }
  return found;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<SessionRow> Catalogue::session(const std::string& id) const try {
  DTS_TRY_ASSIGN(SessionRow session, session_texts(id));
  session.parts = implementation_->parts_of(id);
  session.trials = implementation_->trials_of(id);
  return session;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<SessionRow> Catalogue::session_texts(const std::string& id) const try {
  auto found = rows_of(implementation_->database.query(std::string(kSessionColumns) + "WHERE sessions.id = ?", id), read_session);
  if (found.empty()) return no_session(id);
  SessionRow session = std::move(found.front());
  session.corrections = implementation_->corrections_of(id);
  session.markers = implementation_->markers_of(id, {id, session.corrections});
  return session;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<ResultRow>> Catalogue::results(const std::string& session_id) const try {
  return rows_of(implementation_->database.query(
                     "SELECT session_id, name, value, unit, details FROM results WHERE session_id = ? ORDER BY name", session_id),
                 read_result);
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<PartRow>> Catalogue::unfinished_parts() const try {
  return rows_of(implementation_->database.query(std::string(kPartColumns) + "WHERE state = ? ORDER BY session_id, part",
                                                 static_cast<int>(PartState::Recording)),
                 read_part);
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<PartRow>> Catalogue::parts() const try {
  return rows_of(implementation_->database.query(std::string(kPartColumns) + "ORDER BY session_id, part"), read_part);
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::set<std::pair<std::string, std::uint32_t>>> Catalogue::parts_without_events() const try {
  auto rows = implementation_->database.query("SELECT session_id, part FROM parts WHERE has_events = 0");
  std::set<std::pair<std::string, std::uint32_t>> parts;
  while (rows.step()) parts.emplace(rows.text(0), rows.count32(1));
  return parts;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::set_corrections(const Corrections& corrections, const std::optional<std::vector<ResultRow>>& results) try {
  const Database& database = implementation_->database;
  const std::string& id = corrections.session_id;
  Transaction transaction(database);
  if (!database.query("SELECT 1 FROM sessions WHERE id = ?", id).step()) return no_session(id);
  database.run("DELETE FROM corrections WHERE session_id = ?", id);
  for (const Correction& one : corrections.all) {
    database.run(
        "INSERT INTO corrections (session_id, number, utc_ns, who, field, part, trial, attempt, marker, old_value, new_value, reason)"
        " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
        id, one.number, one.utc_ns, one.who, static_cast<int>(one.field), one.part, one.trial, one.attempt, one.marker, one.old_value,
        one.new_value, one.reason);
  }
  implementation_->apply(corrections);
  if (results) {
    if (auto set = set_results(id, *results); !set) return set;
  }
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::set_results(const std::string& session_id, const std::vector<ResultRow>& results) try {
  Transaction transaction(implementation_->database);
  implementation_->database.run("DELETE FROM results WHERE session_id = ?", session_id);
  for (const ResultRow& result : results) {
    if (auto put = put_result(result); !put) return put;
  }
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::erase(const std::vector<std::string>& session_ids) try {
  const Database& database = implementation_->database;
  Transaction transaction(database);
  for (const std::string& id : session_ids) {
    for (const char* table :
         {"results", "corrections", "trials", "markers", "begun_attempts", "parts"}) {  // rows that refer to others are removed first
      database.run(std::string("DELETE FROM ") + table + " WHERE session_id = ?", id);
    }
    database.run("DELETE FROM sessions WHERE id = ?", id);
  }
  database.run("DELETE FROM subjects WHERE id NOT IN (SELECT subject_id FROM sessions WHERE subject_id IS NOT NULL)");
  transaction.commit();
  return {};
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

void Catalogue::wait_at_most(std::chrono::milliseconds time) const { implementation_->database.wait_at_most(time); }

core::Result<bool> Catalogue::overwrite_removed(const std::string& file, const std::string& folder,
                                                const std::function<bool()>& is_wanted) {
  DTS_TRY_ASSIGN(const auto database, Database::open_again(file));
  try {
    database.wait_at_most(kLongestWait);
    database.interrupt_unless(is_wanted);
    // `secure_delete` is not enough: cells that move to another page leave their bytes. The copy has no name in the folder. It is not made
    // in memory, because ten years of sessions have more than a gigabyte. Other connections keep temporary data in memory.
    std::string quoted = folder;
    for (std::size_t at = 0; (at = quoted.find('\'', at)) != std::string::npos; at += 2) quoted.insert(at, 1, '\'');
    database.execute("PRAGMA temp_store = FILE; PRAGMA temp_store_directory = '" + quoted + "'; VACUUM");
    return database.number("PRAGMA wal_checkpoint(TRUNCATE)") == 0;  // its first column: whether a reader prevents it
  } catch (const SQLite::Exception& exception) {
    return database.failure(exception);
  }
}

core::Result<std::vector<std::string>> Catalogue::sessions_with(const std::string& subject) const try {
  return rows_of(implementation_->database.query(
                     "SELECT sessions.id, COALESCE(sessions.corrected_subject, subjects.pseudonym, '') AS subject"
                     " FROM sessions LEFT JOIN subjects ON subjects.id = sessions.subject_id"
                     " WHERE subject <> ?1 AND (subjects.pseudonym = ?1 OR instr(sessions.label, ?1) > 0 OR"
                     " EXISTS (SELECT 1 FROM markers WHERE markers.session_id = sessions.id AND instr(text, ?1) > 0) OR"
                     " EXISTS (SELECT 1 FROM corrections"
                     " WHERE corrections.session_id = sessions.id AND"
                     " (instr(old_value, ?1) > 0 OR instr(new_value, ?1) > 0 OR instr(reason, ?1) > 0))) ORDER BY sessions.id",
                     subject),
                 [](Statement& row) { return row.text(0); });
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<SubjectRow>> Catalogue::subjects(const SubjectFilter& filter) const try {
  return rows_of(implementation_->database.query(
                     "SELECT COALESCE(sessions.corrected_subject, subjects.pseudonym, '') AS subject, count(*), sum(sessions.is_deleted),"
                     " COALESCE(min(sessions.started_utc_ns) FILTER (WHERE NOT sessions.is_deleted), 0),"
                     " COALESCE(max(sessions.started_utc_ns) FILTER (WHERE NOT sessions.is_deleted), 0),"
                     " COALESCE(sum((SELECT sum(bytes) FROM parts WHERE parts.session_id = sessions.id)), 0),"
                     " group_concat(DISTINCT sessions.rig)"
                     " FROM sessions LEFT JOIN subjects ON subjects.id = sessions.subject_id"
                     " WHERE subject <> '' AND (?1 = '' OR subject = ?1) GROUP BY subject ORDER BY subject LIMIT ?2",
                     filter.subject, filter.limit),
                 read_subject);
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::size_t> Catalogue::count_subjects() const try {
  auto row = implementation_->database.query(
      "SELECT count(DISTINCT COALESCE(sessions.corrected_subject, subjects.pseudonym)) FROM sessions"
      " LEFT JOIN subjects ON subjects.id = sessions.subject_id WHERE sessions.corrected_subject IS NOT ''");
  return row.step() ? row.count(0) : 0;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Result<std::vector<Corrections>> Catalogue::corrections() const try {
  auto ids = implementation_->database.query("SELECT DISTINCT session_id FROM corrections ORDER BY session_id");
  std::vector<Corrections> all;
  while (ids.step()) all.push_back({ids.text(0), implementation_->corrections_of(ids.text(0))});
  return all;
} catch (const SQLite::Exception& exception) {
  return implementation_->database.failure(exception);
}

core::Status Catalogue::append_audit(AuditEntry entry) { return implementation_->audit.append(std::move(entry)); }
core::Result<std::vector<AuditEntry>> Catalogue::audit(std::size_t newest) const { return implementation_->audit.newest(newest); }
core::Result<std::uint64_t> Catalogue::verify_audit() const { return implementation_->audit.verify(); }

}  // namespace dts::record
