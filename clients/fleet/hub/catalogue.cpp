// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/catalogue.h"

#include <algorithm>
#include <string_view>

#include "fleet/hub/audit_trail.h"
#include "fleet/wire/messages.h"

namespace dts::fleet::hub {
namespace {

using database::Column;
using database::Parameter;
using database::Rows;

constexpr int kMostRigs = 64;  // of a clinic

/// A time of PostgreSQL from ns; it keeps microseconds.
std::string time_of(const char* parameter) {
  return "'epoch'::timestamptz + (" + std::string(parameter) + "::bigint / 1000) * interval '1 microsecond'";
}

/// Returns "streaming" for DEVICE_STATE_STREAMING, and an empty text for the unspecified value.
std::string word_of(std::string_view name, std::string_view prefix) {
  if (name.starts_with(prefix)) name.remove_prefix(prefix.size());
  if (name == "UNSPECIFIED") return {};
  std::string word(name);
  std::ranges::transform(word, word.begin(),
                         [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter; });
  return word;
}

std::optional<std::string> text_or_null(const std::string& text) { return text.empty() ? std::nullopt : std::optional(text); }

std::optional<std::int64_t> time_or_null(std::int64_t utc_ns) { return utc_ns == 0 ? std::nullopt : std::optional(utc_ns); }

core::Result<v1::Receipt> receipt_of(const RecordingName& name, const Rows& rows) {
  v1::Receipt receipt;
  receipt.set_clinic(name.clinic);
  receipt.set_sha256(name.sha256);
  DTS_TRY_ASSIGN(const std::int64_t bytes, rows.integer(0, 0));
  receipt.set_bytes(static_cast<std::uint64_t>(bytes));
  DTS_TRY_ASSIGN(const std::int64_t microseconds, rows.integer(0, 1));
  receipt.set_stored_utc_ns(microseconds * 1000);
  receipt.set_hub(rows.text(0, 2));
  return receipt;
}

tl::unexpected<core::Error> erased_before(const std::string& session) {
  return core::fail(core::ErrorCode::NotFound, "session " + session + " was erased");
}

tl::unexpected<core::Error> quota_used_up(const char* what, std::uint64_t most) {
  return core::fail(core::ErrorCode::WrongState, "this clinic has used up its quota at the centre: " + std::to_string(most) + " " + what,
                    "ask the centre to increase [quota] in hub.toml");
}

/// A number of `row_count` of clinic $1.
std::string counted(const char* column) {
  return "(SELECT coalesce(sum(" + std::string(column) + "), 0)::bigint FROM row_count WHERE clinic = $1)";
}

std::uint64_t rows_of(const v1::FleetSession& session) {
  return static_cast<std::uint64_t>(session.parts_size()) + static_cast<std::uint64_t>(session.trials_size()) +
         static_cast<std::uint64_t>(session.results_size());
}

}  // namespace

core::Result<std::vector<Clinic>> Catalogue::clinics() {
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT id, title, nkey, state = 'revoked', to_char(added, 'YYYY-MM-DD HH24:MI'), "
                                                 "to_char(revoked, 'YYYY-MM-DD HH24:MI') FROM clinic ORDER BY id"));
  std::vector<Clinic> clinics;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    clinics.push_back({.id = rows.text(row, 0),
                       .title = rows.text(row, 1),
                       .nkey = rows.text(row, 2),
                       .is_revoked = rows.boolean(row, 3),
                       .added = rows.text(row, 4),
                       .revoked = rows.text(row, 5)});
  }
  return clinics;
}

core::Status Catalogue::add_clinic(const Clinic& clinic, const std::string& who, std::int64_t utc_ns) {
  return database_->transaction([&]() -> core::Status {
    DTS_TRY(database_->run("INSERT INTO clinic (id, title, nkey) VALUES ($1, $2, $3)", {clinic.id, clinic.title, clinic.nkey}));
    DTS_TRY(append_audit(*database_, utc_ns, who, "add_clinic", clinic.id));
    DTS_TRY(database_->run("NOTIFY clinic"));
    return {};
  });
}

core::Status Catalogue::revoke_clinic(const std::string& clinic, const std::string& who, std::int64_t utc_ns) {
  return database_->transaction([&]() -> core::Status {
    DTS_TRY_ASSIGN(const Rows known, database_->run("SELECT state FROM clinic WHERE id = $1 FOR UPDATE", {clinic}));
    if (known.empty()) return core::fail(core::ErrorCode::NotFound, "there is no clinic '" + clinic + "'", "dts-fleet clinic list");
    if (known.text(0, 0) == "revoked") return core::fail(core::ErrorCode::WrongState, "clinic '" + clinic + "' is revoked already");
    DTS_TRY(database_->run("UPDATE clinic SET state = 'revoked', revoked = now() WHERE id = $1", {clinic}));
    DTS_TRY(append_audit(*database_, utc_ns, who, "revoke_clinic", clinic));
    DTS_TRY(database_->run("NOTIFY clinic"));
    return {};
  });
}

/// Facts, receipts and the erasure of one session wait for each other: else a recording that is committed during the erasure would stay.
core::Status Catalogue::lock_session(const std::string& clinic, const std::string& session) {
  DTS_TRY(database_->run("SELECT pg_advisory_xact_lock(hashtextextended($1 || '/' || $2, 0))", {clinic, session}));
  return {};
}

/// A receipt is entered, and a recording without receipt removed, one after the other, also by several hubs that share a store.
core::Status Catalogue::lock_recording(const RecordingName& name) {
  DTS_TRY(database_->run("SELECT pg_advisory_xact_lock(hashtextextended($1 || '/' || encode($2::bytea, 'hex'), 1))",
                         {name.clinic, Parameter::binary(name.sha256)}));
  return {};
}

core::Result<std::uint64_t> Catalogue::put_session(const std::string& clinic, const v1::FleetSession& session) {
  return database_->transaction([&]() -> core::Result<std::uint64_t> {
    DTS_TRY(lock_session(clinic, session.session_id()));
    static const std::string kKnown = "SELECT s.revision, EXISTS (SELECT FROM erased WHERE clinic = $1 AND session = $2), " +
                                      counted("sessions") + ", " + counted("rows") +
                                      " - coalesce(s.rows, 0) FROM (VALUES (1)) one LEFT JOIN session s ON s.clinic = $1 AND s.id = $2";
    DTS_TRY_ASSIGN(const Rows known, database_->run(kKnown, {clinic, session.session_id()}));
    if (known.boolean(0, 1)) return erased_before(session.session_id());
    DTS_TRY_ASSIGN(const std::int64_t revision, known.integer(0, 0));
    if (static_cast<std::uint64_t>(revision) >= session.revision()) return static_cast<std::uint64_t>(revision);
    DTS_TRY_ASSIGN(const std::int64_t sessions, known.integer(0, 2));
    DTS_TRY_ASSIGN(const std::int64_t other_rows, known.integer(0, 3));
    if (quota_ && known.is_null(0, 0) && static_cast<std::uint64_t>(sessions) >= quota_->sessions) {
      return quota_used_up("sessions", quota_->sessions);
    }
    if (quota_ && static_cast<std::uint64_t>(other_rows) + rows_of(session) > quota_->rows) {
      return quota_used_up("parts, trials and results", quota_->rows);
    }
    return put_session_rows(clinic, session, known.is_null(0, 0));
  });
}

core::Result<std::uint64_t> Catalogue::put_session_rows(const std::string& clinic, const v1::FleetSession& session, bool is_new) {
  Column names;
  Column values;
  for (const auto& [name, value] : session.fields()) {
    names.add(name);
    values.add(value);
  }
  static const std::string kPut =
      "INSERT INTO session (clinic, id, revision, rig, protocol, subject, state, started, ended, planned_trials, is_deleted, label, notes, "
      "fields, rows) VALUES ($1, $2, $3, $4, $5, $6, $7, " +
      time_of("$8") + ", " + time_of("$9") +
      ", $10, $11, $12, $13, jsonb_object($14::text[], $15::text[]), $16) "
      "ON CONFLICT (clinic, id) DO UPDATE SET revision = excluded.revision, rig = excluded.rig, protocol = excluded.protocol, "
      "subject = excluded.subject, state = excluded.state, started = excluded.started, ended = excluded.ended, "
      "planned_trials = excluded.planned_trials, is_deleted = excluded.is_deleted, label = excluded.label, notes = excluded.notes, "
      "fields = excluded.fields, rows = excluded.rows, received = now() WHERE session.revision < excluded.revision";
  DTS_TRY(database_->run(
      kPut,
      {clinic, session.session_id(), session.revision(), session.rig(), session.protocol(), text_or_null(session.subject()),
       session.state(), session.started_utc_ns(), session.has_ended_utc_ns() ? std::optional(session.ended_utc_ns()) : std::nullopt,
       session.planned_trials(), session.is_deleted(), session.has_label() ? std::optional(session.label()) : std::nullopt,
       session.has_notes() ? std::optional(session.notes()) : std::nullopt, names.parameter(), values.parameter(), rows_of(session)}));
  DTS_TRY(put_parts(clinic, session));
  DTS_TRY(put_trials(clinic, session, is_new));
  DTS_TRY(put_results(clinic, session, is_new));
  return session.revision();
}

core::Status Catalogue::put_parts(const std::string& clinic, const v1::FleetSession& session) {
  Column numbers, sums, recorded_sums, bytes, states, scans, durations, lost, unknown, valid, rigs, leading;
  for (const auto& part : session.parts()) {
    numbers.add(part.part());
    sums.add(wire::hex_of(part.sha256()));
    recorded_sums.add(wire::hex_of(part.recorded_sha256()));
    bytes.add(part.bytes());
    states.add(word_of(v1::PartState_Name(part.state()), "PART_STATE_"));
    scans.add(part.scans());
    durations.add(part.duration_s());
    lost.add(part.lost_scans());
    unknown.add(part.is_loss_unknown());
    valid.add(part.valid_trials());
    rigs.add(part.rig());
    leading.add(part.leading_part());
  }
  // A stored recording stays, whatever the facts say: its row shows that the clinic has it no longer.
  DTS_TRY(database_->run("DELETE FROM part WHERE clinic = $1 AND session = $2 AND part <> ALL ($3::bigint[]) AND store_key IS NULL",
                         {clinic, session.session_id(), numbers.parameter()}));
  if (session.parts().empty()) return {};
  // Facts of a part that was not closed yet do not change what is known of its recording.
  static const std::string kPut =
      "INSERT INTO part (clinic, session, part, sha256, recorded_sha256, bytes, state, scans, duration_s, lost_scans, is_loss_unknown, "
      "valid_trials, rig, leading_part, stored_utc, store_key) "
      "SELECT $1, $2, n.part, n.sha256, n.recorded, n.bytes, nullif(n.state, ''), n.scans, n.duration_s, n.lost, n.unknown, n.valid, "
      "nullif(n.rig, ''), n.leader, r.stored_utc, r.store_key FROM (SELECT u.part, decode(nullif(u.sum, ''), 'hex') AS sha256, "
      "decode(nullif(u.recorded, ''), 'hex') AS recorded, u.bytes, u.state, u.scans, u.duration_s, u.lost, u.unknown, u.valid, u.rig, "
      "u.leader "
      "FROM unnest($3::bigint[], $4::text[], $5::text[], $6::bigint[], $7::text[], $8::bigint[], $9::float8[], $10::bigint[], "
      "$11::boolean[], $12::bigint[], $13::text[], $14::bigint[]) AS u (part, sum, recorded, bytes, state, scans, duration_s, lost, "
      "unknown, valid, rig, leader)) n "
      "LEFT JOIN receipt r ON r.clinic = $1 AND r.sha256 = n.sha256 "
      "ON CONFLICT (clinic, session, part) DO UPDATE SET state = excluded.state, scans = excluded.scans, "
      "duration_s = excluded.duration_s, lost_scans = excluded.lost_scans, is_loss_unknown = excluded.is_loss_unknown, "
      "valid_trials = excluded.valid_trials, rig = excluded.rig, leading_part = excluded.leading_part, recorded_sha256 = "
      "coalesce(excluded.recorded_sha256, part.recorded_sha256), "
      "sha256 = coalesce(excluded.sha256, part.sha256), "
      "bytes = CASE WHEN excluded.sha256 IS NULL AND part.sha256 IS NOT NULL THEN part.bytes ELSE excluded.bytes END, "
      "stored_utc = CASE WHEN excluded.sha256 IS NULL THEN part.stored_utc ELSE excluded.stored_utc END, "
      "store_key = CASE WHEN excluded.sha256 IS NULL THEN part.store_key ELSE excluded.store_key END";
  DTS_TRY(database_->run(kPut, {clinic, session.session_id(), numbers.parameter(), sums.parameter(), recorded_sums.parameter(),
                                bytes.parameter(), states.parameter(), scans.parameter(), durations.parameter(), lost.parameter(),
                                unknown.parameter(), valid.parameter(), rigs.parameter(), leading.parameter()}));
  return {};
}

core::Status Catalogue::put_trials(const std::string& clinic, const v1::FleetSession& session, bool is_new) {
  Column parts, numbers, attempts, blocks, conditions, outcomes, recorded, faults;
  for (const auto& trial : session.trials()) {
    parts.add(trial.part());
    numbers.add(trial.trial());
    attempts.add(trial.attempt());
    blocks.add(trial.block());
    conditions.add(trial.condition());
    outcomes.add(trial.outcome());
    recorded.add(trial.recorded_outcome());
    faults.add(word_of(v1::TrialFault_Name(trial.fault()), "TRIAL_FAULT_"));
  }
  if (!is_new) DTS_TRY(database_->run("DELETE FROM trial WHERE clinic = $1 AND session = $2", {clinic, session.session_id()}));
  if (session.trials().empty()) return {};
  DTS_TRY(
      database_->run("INSERT INTO trial SELECT $1, $2, * FROM unnest($3::bigint[], $4::bigint[], $5::bigint[], $6::bigint[], "
                     "$7::text[], $8::text[], $9::text[], $10::text[])",
                     {clinic, session.session_id(), parts.parameter(), numbers.parameter(), attempts.parameter(), blocks.parameter(),
                      conditions.parameter(), outcomes.parameter(), recorded.parameter(), faults.parameter()}));
  return {};
}

core::Status Catalogue::put_results(const std::string& clinic, const v1::FleetSession& session, bool is_new) {
  Column names, values, units;
  for (const auto& result : session.results()) {
    names.add(result.name());
    values.add(result.value());
    units.add(result.unit());
  }
  if (!is_new) {
    DTS_TRY(database_->run("DELETE FROM result WHERE clinic = $1 AND session = $2 AND analysis = 'clinic' AND name <> ALL ($3::text[])",
                           {clinic, session.session_id(), names.parameter()}));
  }
  if (session.results().empty()) return {};
  DTS_TRY(database_->run(
      "INSERT INTO result (clinic, session, name, analysis, value, unit, started, week, protocol) SELECT $1, $2, u.name, 'clinic', "
      "u.value, "
      "u.unit, s.started, week_of(s.started), s.protocol FROM unnest($3::text[], $4::float8[], $5::text[]) AS u (name, value, unit), "
      "(SELECT CASE WHEN NOT is_deleted THEN started END AS started, protocol FROM session WHERE clinic = $1 AND id = $2) s "
      "ON CONFLICT (clinic, session, name, analysis) DO UPDATE SET value = excluded.value, unit = excluded.unit "
      "WHERE (result.value, result.unit) IS DISTINCT FROM (excluded.value, excluded.unit)",
      {clinic, session.session_id(), names.parameter(), values.parameter(), units.parameter()}));
  return {};
}

core::Result<std::vector<RecordingName>> Catalogue::names(const Rows& rows) const {
  std::vector<RecordingName> found;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    DTS_TRY_ASSIGN(auto sum, wire::bytes_of_hex(rows.text(row, 1)));
    found.push_back({.clinic = rows.text(row, 0), .sha256 = std::move(sum)});
  }
  return found;
}

core::Status Catalogue::erase_session(const SessionName& name, const std::string& who, std::int64_t utc_ns) {
  return database_->transaction([&]() -> core::Status {
    DTS_TRY(lock_session(name.clinic, name.id));
    DTS_TRY_ASSIGN(const Rows added,
                   database_->run("INSERT INTO erased (clinic, session) VALUES ($1, $2) ON CONFLICT DO NOTHING", {name.clinic, name.id}));
    // The rows go first, and name what has to be removed from the store: a receipt without a recording must never exist. Facts may have
    // announced a recording of this session that has arrived as part of another one: it is the erased session's.
    for (const char* sql : {"INSERT INTO erased_file (clinic, sha256) SELECT clinic, sha256 FROM part WHERE clinic = $1 AND session = $2 "
                            "AND sha256 IS NOT NULL "
                            "UNION SELECT clinic, sha256 FROM receipt WHERE clinic = $1 AND session = $2 ON CONFLICT DO NOTHING",
                            "UPDATE part SET stored_utc = NULL, store_key = NULL WHERE clinic = $1 AND session <> $2 AND sha256 IN "
                            "(SELECT sha256 FROM receipt WHERE clinic = $1 AND session = $2)",
                            "DELETE FROM receipt WHERE clinic = $1 AND (session = $2 OR sha256 IN (SELECT sha256 FROM part WHERE clinic = "
                            "$1 AND session = $2))",
                            "DELETE FROM part WHERE clinic = $1 AND session = $2", "DELETE FROM job WHERE clinic = $1 AND session = $2",
                            "DELETE FROM session WHERE clinic = $1 AND id = $2"}) {
      DTS_TRY(database_->run(sql, {name.clinic, name.id}));
    }
    return added.changed() == 0 ? core::Status() : append_audit(*database_, utc_ns, who, "erase_session", name.clinic + "/" + name.id);
  });
}

core::Result<std::set<SessionName>> Catalogue::erased_sessions() {
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT clinic, session FROM erased"));
  std::set<SessionName> erased;
  for (std::size_t row = 0; row < rows.size(); ++row) erased.insert({.clinic = rows.text(row, 0), .id = rows.text(row, 1)});
  return erased;
}

core::Status Catalogue::check_room_for_erasure(const std::string& clinic) {
  if (!quota_) return {};
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT " + counted("erased"), {clinic}));
  DTS_TRY_ASSIGN(const std::int64_t erased, rows.integer(0, 0));
  if (static_cast<std::uint64_t>(erased) < quota_->erased_sessions) return {};
  return quota_used_up("erased sessions", quota_->erased_sessions);
}

core::Status Catalogue::check_room_for_recording(const std::string& clinic) {
  if (!quota_) return {};
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT " + counted("recordings"), {clinic}));
  DTS_TRY_ASSIGN(const std::int64_t recordings, rows.integer(0, 0));
  if (static_cast<std::uint64_t>(recordings) < quota_->recordings) return {};
  return quota_used_up("recordings", quota_->recordings);
}

core::Result<SessionContent> Catalogue::content_of(const SessionName& name) {
  DTS_TRY_ASSIGN(const Rows rows,
                 database_->run("SELECT s.id IS NOT NULL, EXISTS (SELECT FROM erased WHERE clinic = $1 AND session = $2), "
                                "to_char(s.started, 'YYYY-MM-DD HH24:MI'), "
                                "s.protocol, r.recordings, r.bytes, (SELECT count(*) FROM part WHERE clinic = $1 AND session = $2) + "
                                "(SELECT count(*) FROM trial WHERE clinic = $1 AND session = $2) + (SELECT count(*) FROM result WHERE "
                                "clinic = $1 AND session = $2) "
                                "FROM (SELECT count(*) AS recordings, coalesce(sum(bytes), 0)::bigint AS bytes FROM receipt WHERE clinic = "
                                "$1 AND session = $2) r "
                                "LEFT JOIN session s ON s.clinic = $1 AND s.id = $2",
                                {name.clinic, name.id}));
  SessionContent content{
      .is_known = rows.boolean(0, 0), .is_erased = rows.boolean(0, 1), .started = rows.text(0, 2), .protocol = rows.text(0, 3)};
  DTS_TRY_ASSIGN(content.recordings, rows.integer(0, 4));
  DTS_TRY_ASSIGN(content.bytes, rows.integer(0, 5));
  DTS_TRY_ASSIGN(content.rows, rows.integer(0, 6));
  return content;
}

core::Result<std::vector<RecordingName>> Catalogue::left_recordings(const std::string& clinic) {
  DTS_TRY_ASSIGN(const Rows rows,
                 database_->run("SELECT clinic, encode(sha256, 'hex') FROM erased_file WHERE $1 = '' OR clinic = $1", {clinic}));
  return names(rows);
}

core::Result<bool> Catalogue::remove_left(const RecordingName& name, Store& store) {
  auto removed = remove_recording(name, store);
  if (removed || removed.error().code != core::ErrorCode::WrongState) return removed;
  // It was received again, as part of a session that is not erased.
  DTS_TRY(database_->run("DELETE FROM erased_file WHERE clinic = $1 AND sha256 = $2", {name.clinic, Parameter::binary(name.sha256)}));
  return false;
}

core::Result<bool> Catalogue::remove_recording(const RecordingName& name, Store& store) {
  return database_->transaction([&]() -> core::Result<bool> {
    DTS_TRY(lock_recording(name));
    DTS_TRY_ASSIGN(const auto receipt, find_receipt(name));
    if (receipt) return core::fail(core::ErrorCode::WrongState, "recording " + key_of(name) + " has a receipt and stays");
    DTS_TRY_ASSIGN(const bool is_removed, store.remove(name));
    DTS_TRY(database_->run("DELETE FROM erased_file WHERE clinic = $1 AND sha256 = $2", {name.clinic, Parameter::binary(name.sha256)}));
    return is_removed;
  });
}

core::Result<bool> Catalogue::is_erased(const std::string& clinic, const std::string& session) {
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT FROM erased WHERE clinic = $1 AND session = $2", {clinic, session}));
  return !rows.empty();
}

core::Result<std::optional<v1::Receipt>> Catalogue::find_receipt(const RecordingName& name) {
  DTS_TRY_ASSIGN(const Rows rows, database_->run("SELECT bytes, (extract(epoch FROM stored_utc) * 1000000)::bigint, hub FROM receipt "
                                                 "WHERE clinic = $1 AND sha256 = $2",
                                                 {name.clinic, Parameter::binary(name.sha256)}));
  if (rows.empty()) return std::optional<v1::Receipt>();
  DTS_TRY_ASSIGN(auto receipt, receipt_of(name, rows));
  return std::optional(std::move(receipt));
}

core::Result<v1::Receipt> Catalogue::put_recording(const RecordingName& name, const v1::UploadOffer& offer, const Store& store,
                                                   const std::string& hub, std::int64_t stored_utc_ns) {
  DTS_TRY_ASSIGN(auto receipt, database_->transaction([&]() -> core::Result<std::optional<v1::Receipt>> {
    DTS_TRY(lock_session(name.clinic, offer.session_id()));
    DTS_TRY_ASSIGN(const bool is_gone, is_erased(name.clinic, offer.session_id()));
    if (is_gone) return erased_before(offer.session_id());
    DTS_TRY(lock_recording(name));
    DTS_TRY_ASSIGN(const bool is_stored, store.has(name));
    if (!is_stored) return core::fail(core::ErrorCode::DataDamaged, "recording " + key_of(name) + " is no longer in the store");
    const std::string store_key = key_of(name);
    // A newer recording of this part that the facts have announced stays announced.
    static const std::string kPutPart =
        "INSERT INTO part (clinic, session, part, sha256, bytes, stored_utc, store_key) VALUES ($1, $2, $3, $4, $5, " + time_of("$6") +
        ", $7) ON CONFLICT (clinic, session, part) DO UPDATE SET sha256 = excluded.sha256, "
        "bytes = excluded.bytes, stored_utc = coalesce(part.stored_utc, excluded.stored_utc), "
        "store_key = excluded.store_key WHERE part.sha256 IS NULL OR part.sha256 = excluded.sha256";
    static const std::string kPutReceipt =
        "INSERT INTO receipt (clinic, sha256, bytes, session, part, stored_utc, hub, store_key) VALUES ($1, $2, $3, $4, $5, " +
        time_of("$6") + ", $7, $8) ON CONFLICT DO NOTHING";
    const auto sum = Parameter::binary(name.sha256);
    DTS_TRY(database_->run(kPutPart, {name.clinic, offer.session_id(), offer.part(), sum, offer.bytes(), stored_utc_ns, store_key}));
    DTS_TRY(
        database_->run(kPutReceipt, {name.clinic, sum, offer.bytes(), offer.session_id(), offer.part(), stored_utc_ns, hub, store_key}));
    return find_receipt(name);
  }));
  if (receipt) return *std::move(receipt);
  return core::fail(core::ErrorCode::Internal, "the receipt that was just written is missing");
}

core::Status Catalogue::put_header(const std::string& clinic, const record::SessionFacts& facts) {
  static const std::string kPut =
      "INSERT INTO session (clinic, id, revision, rig, protocol, subject, state, started, planned_trials, is_deleted, fields) VALUES ($1, "
      "$2, 0, "
      "$3, $4, $5, 'unknown', " +
      time_of("$6") + ", 0, false, '{}') ON CONFLICT DO NOTHING";
  DTS_TRY(database_->run(kPut, {clinic, facts.session_id, facts.rig, facts.protocol, text_or_null(facts.subject), facts.started_utc_ns}));
  return {};
}

core::Result<std::string> Catalogue::put_beat(const std::string& clinic, const v1::Beat& beat, std::int64_t received_utc_ns) {
  const double offset_s = static_cast<double>(beat.utc_ns() - received_utc_ns) * 1e-9;
  static const std::string kPut =
      "WITH newest AS (INSERT INTO beat (clinic, at, clock_offset_s, forwarder_version, has_daemon, daemon_version, disk_state, "
      "disk_free_bytes, recordable_s, backlog_files, backlog_bytes, backlog_oldest, last_receipt, held_files) VALUES ($1, " +
      time_of("$2") + ", $3, $4, $5, $6, $7, $8, $9, $10, $11, " + time_of("$12") + ", " + time_of("$13") +
      ", $14) ON CONFLICT (clinic) DO UPDATE SET at = excluded.at, clock_offset_s = excluded.clock_offset_s, "
      "forwarder_version = excluded.forwarder_version, has_daemon = excluded.has_daemon, daemon_version = excluded.daemon_version, "
      "disk_state = excluded.disk_state, disk_free_bytes = excluded.disk_free_bytes, recordable_s = excluded.recordable_s, "
      "backlog_files = excluded.backlog_files, backlog_bytes = excluded.backlog_bytes, backlog_oldest = excluded.backlog_oldest, "
      "last_receipt = excluded.last_receipt, held_files = excluded.held_files), "
      "past AS (INSERT INTO beat_history AS h VALUES ($1, (" +
      time_of("$2") + ")::date, 1, " + time_of("$2") + ", " + time_of("$2") +
      ", abs($3), $11, $8) ON CONFLICT (clinic, day) DO UPDATE SET beats = h.beats + 1, last_at = greatest(h.last_at, excluded.last_at), "
      "largest_clock_offset_s = greatest(h.largest_clock_offset_s, excluded.largest_clock_offset_s), "
      "largest_backlog_bytes = greatest(h.largest_backlog_bytes, excluded.largest_backlog_bytes), "
      "least_disk_free_bytes = least(h.least_disk_free_bytes, excluded.least_disk_free_bytes)) "
      "SELECT (SELECT hash FROM audit ORDER BY number DESC LIMIT 1)";
  const auto& backlog = beat.backlog();
  DTS_TRY_ASSIGN(
      const Rows rows,
      database_->run(kPut, {clinic, received_utc_ns, offset_s, beat.forwarder_version(), beat.has_daemon(), beat.daemon_version(),
                            word_of(v1::DiskState_Name(beat.disk().state()), "DISK_STATE_"), beat.disk().free_bytes(),
                            beat.disk().recordable_s(), backlog.files(), backlog.bytes(), time_or_null(backlog.oldest_utc_ns()),
                            time_or_null(backlog.last_receipt_utc_ns()), backlog.held_files()}));
  if (!beat.rigs().empty()) DTS_TRY(put_rigs(clinic, beat, received_utc_ns));
  if (rows.is_null(0, 0)) return std::string();
  return wire::bytes_of_hex(rows.text(0, 0));
}

core::Status Catalogue::put_rigs(const std::string& clinic, const v1::Beat& beat, std::int64_t received_utc_ns) {
  Column ids, kinds, sensors, devices, nominal, measured, scans, lost, gaps, states, sessions, calibrations, streams;
  for (const auto& rig : beat.rigs()) {
    ids.add(rig.rig());
    kinds.add(rig.kind());
    sensors.add(rig.sensors());
    devices.add(word_of(v1::DeviceState_Name(rig.device()), "DEVICE_STATE_"));
    nominal.add(rig.nominal_rate_hz());
    measured.add(rig.has_measured_rate_hz() ? std::optional(rig.measured_rate_hz()) : std::nullopt);
    scans.add(rig.scans_total());
    lost.add(rig.lost_scans_total());
    gaps.add(rig.gaps_total());
    states.add(word_of(v1::SessionState_Name(rig.session()), "SESSION_STATE_"));
    sessions.add(rig.session_id());
    calibrations.add(rig.calibration());
    std::string names;
    for (const auto& stream : rig.streams()) names += (names.empty() ? "" : ",") + stream;
    streams.add(names);
  }
  static const std::string kPut =
      "INSERT INTO rig (clinic, id, kind, sensors, device, nominal_rate_hz, measured_rate_hz, scans_total, lost_scans_total, gaps_total, "
      "session_state, session, calibration, calibration_since, streams, at) SELECT $1, u.id, u.kind, u.sensors, u.device, u.nominal, "
      "u.measured, u.scans, u.lost, u.gaps, u.state, u.session, u.calibration, " +
      time_of("$2") + ", string_to_array(u.streams, ','), " + time_of("$2") +
      " FROM unnest($3::text[], $4::text[], $5::bigint[], $6::text[], $7::float8[], $8::float8[], $9::bigint[], $10::bigint[], "
      "$11::bigint[], $12::text[], $13::text[], $14::text[], $15::text[]) AS u (id, kind, sensors, device, nominal, measured, scans, lost, "
      "gaps, state, session, calibration, streams) "
      "ON CONFLICT (clinic, id) DO UPDATE SET kind = excluded.kind, sensors = excluded.sensors, device = excluded.device, "
      "nominal_rate_hz = excluded.nominal_rate_hz, measured_rate_hz = excluded.measured_rate_hz, scans_total = excluded.scans_total, "
      "lost_scans_total = excluded.lost_scans_total, gaps_total = excluded.gaps_total, session_state = excluded.session_state, "
      "session = excluded.session, calibration = excluded.calibration, calibration_since = CASE WHEN rig.calibration = "
      "excluded.calibration THEN rig.calibration_since ELSE excluded.calibration_since END, streams = excluded.streams, at = excluded.at";
  DTS_TRY(database_->run(kPut, {clinic, received_utc_ns, ids.parameter(), kinds.parameter(), sensors.parameter(), devices.parameter(),
                                nominal.parameter(), measured.parameter(), scans.parameter(), lost.parameter(), gaps.parameter(),
                                states.parameter(), sessions.parameter(), calibrations.parameter(), streams.parameter()}));
  // Rigs whose names a clinic uses no longer stay, but not without end.
  DTS_TRY(
      database_->run("DELETE FROM rig WHERE clinic = $1 AND id IN (SELECT id FROM rig WHERE clinic = $1 ORDER BY at DESC, id OFFSET $2)",
                     {clinic, kMostRigs}));
  return {};
}

core::Status Catalogue::prune_history() {
  DTS_TRY(database_->run("DELETE FROM beat_history WHERE day < current_date - 90"));
  return {};
}

}  // namespace dts::fleet::hub
