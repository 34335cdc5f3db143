// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/pages.h"

#include <charconv>

#include "fleet/wire/subjects.h"

namespace dts::fleet::desk {
namespace {

using database::Database;
using database::Rows;

/// What the page shows of a clinic. $1: version of the centre, $2: the clinic; empty: all. A rig that the newest heartbeat does not have is
/// shown, but nothing is wrong with it. Numbers of a version have at most six digits, so that they fit an integer.
constexpr char kClinics[] = R"sql(
WITH known AS (
  SELECT r.*, r.at = b.at AS is_present, calibration <> '' AND calibration_since < now() - interval '180 days' AS has_old_calibration
  FROM rig r LEFT JOIN beat b USING (clinic) WHERE $2 = '' OR r.clinic = $2
), rigs AS (
  SELECT clinic,
    json_agg(json_build_object('rig', id, 'kind', kind, 'device', device, 'session_state', session_state, 'session', session,
      'nominal_rate_hz', nominal_rate_hz, 'measured_rate_hz', measured_rate_hz, 'scans', scans_total, 'lost_scans', lost_scans_total,
      'gaps', gaps_total, 'sensors', sensors, 'calibration', calibration, 'streams', streams, 'is_present', coalesce(is_present, false),
      'has_old_calibration', has_old_calibration,
      'calibration_age_d', CASE WHEN calibration <> '' THEN extract(epoch FROM now() - calibration_since) / 86400 END) ORDER BY id) AS list,
    bool_or(is_present AND device NOT IN ('streaming', 'waiting')) AS has_no_device,
    bool_or(is_present AND lost_scans_total > 0) AS has_losses,
    bool_or(is_present AND has_old_calibration) AS has_old_calibration
  FROM known GROUP BY clinic
), facts AS (
  SELECT c.id AS name, c.title, c.state = 'revoked' AS is_revoked, extract(epoch FROM now() - b.at) AS beat_age_s, b.clock_offset_s,
    b.forwarder_version, b.has_daemon, b.daemon_version, b.disk_state, b.disk_free_bytes, b.recordable_s, b.backlog_files,
    b.backlog_bytes, extract(epoch FROM now() - b.backlog_oldest) AS backlog_age_s,
    (extract(epoch FROM b.last_receipt) * 1000)::bigint AS last_receipt_ms, b.held_files, coalesce(r.list, '[]') AS rigs,
    CASE WHEN c.state = 'revoked' THEN ARRAY[]::text[] ELSE array_remove(ARRAY[
      CASE WHEN b.at IS NULL OR b.at < now() - interval '30 s' THEN 'no_beat' END,
      CASE WHEN NOT b.has_daemon THEN 'no_daemon' END,
      CASE WHEN r.has_no_device THEN 'no_device' END,
      CASE WHEN b.disk_state IN ('low', 'full', 'unusable') THEN 'disk' END,
      CASE WHEN r.has_losses THEN 'losses' END,
      CASE WHEN b.held_files > 0 THEN 'held' END,
      CASE WHEN b.backlog_oldest < now() - interval '1 day' THEN 'backlog' END,
      CASE WHEN r.has_old_calibration THEN 'calibration' END,
      CASE WHEN abs(b.clock_offset_s) > 1 THEN 'clock' END,
      CASE WHEN least(string_to_array(substring(b.forwarder_version from '^\d{1,6}(?:\.\d{1,6}){0,3}'), '.')::int[],
                      string_to_array(substring(b.daemon_version from '^\d{1,6}(?:\.\d{1,6}){0,3}'), '.')::int[])
                < string_to_array($1, '.')::int[] THEN 'version' END], NULL) END AS wrong
  FROM clinic c LEFT JOIN beat b ON b.clinic = c.id LEFT JOIN rigs r ON r.clinic = c.id WHERE $2 = '' OR c.id = $2
)
)sql";

/// Returns the only cell of a statement.
core::Result<std::string> only_cell(core::Result<Rows> rows) {
  DTS_TRY(rows);
  return rows->text(0, 0);
}

/// Drops what follows the numbers of a version: "0.2.0-dev".
std::string numbers_of(std::string_view version) { return std::string(version.substr(0, version.find_first_not_of("0123456789."))); }

}  // namespace

std::optional<SessionKey> parse_session_key(std::string_view text) {
  SessionKey key;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), key.started_us);
  if (error != std::errc()) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  const std::size_t second = text.find(',', 1);
  if (!text.starts_with(',') || second == std::string_view::npos || second + 1 == text.size()) return std::nullopt;
  key.clinic = text.substr(1, second - 1);
  key.id = text.substr(second + 1);
  constexpr std::int64_t kLargest_us = INT64_MAX / 1000;  // as much as a start in ns can be
  if (!wire::is_clinic_name(key.clinic) || key.started_us < 0 || key.started_us > kLargest_us) return std::nullopt;
  return key;
}

core::Result<std::string> clinics_page(Database& database, std::string_view version) {
  static const std::string kSql = std::string(kClinics) +
                                  "SELECT json_build_object('version', $1::text, 'clinics', coalesce(json_agg(f ORDER BY f.is_revoked, "
                                  "cardinality(f.wrong) = 0, f.name), '[]')) FROM facts f";
  return only_cell(database.run(kSql, {numbers_of(version), ""}));
}

core::Result<std::string> clinic_page(Database& database, std::string_view version, const std::string& clinic) {
  static const std::string kSql =
      std::string(kClinics) +
      "SELECT json_build_object('version', $1::text, 'clinic', row_to_json(f), "
      "'history', (SELECT coalesce(json_agg(h ORDER BY h.day), '[]') FROM (SELECT day, beats, largest_backlog_bytes, "
      "least_disk_free_bytes, largest_clock_offset_s FROM beat_history WHERE clinic = $2 ORDER BY day DESC LIMIT 90) h), "
      "'receipts', (SELECT coalesce(json_agg(r ORDER BY r.stored_ms DESC), '[]') FROM (SELECT session, part, bytes, "
      "encode(sha256, 'hex') AS sha256, (extract(epoch FROM stored_utc) * 1000)::bigint AS stored_ms, hub FROM receipt WHERE clinic = $2 "
      "ORDER BY stored_utc DESC LIMIT 10) r)) FROM facts f";
  DTS_TRY_ASSIGN(const Rows rows, database.run(kSql, {numbers_of(version), clinic}));
  if (rows.empty()) return core::fail(core::ErrorCode::NotFound, "no clinic '" + clinic + "'", "choose a clinic on the page Clinics");
  return rows.text(0, 0);
}

core::Result<std::string> sessions_page(Database& database, const SessionFilter& filter) {
  static const std::string kSql = R"sql(
WITH page AS (
  SELECT clinic, id, rig, protocol, subject, state, started, ended, planned_trials, label FROM session
  WHERE NOT is_deleted AND ($1 = '' OR clinic = $1) AND ($3 = '' OR protocol = $3)
    AND ($2 = '' OR rig = $2 OR EXISTS (SELECT FROM part p WHERE p.clinic = session.clinic AND p.session = session.id AND p.rig = $2))
    AND ($4 = '' OR subject = $4) AND ($5::bigint IS NULL OR started >= to_timestamp($5::bigint / 1000.0))
    AND ($6::bigint IS NULL OR (started, clinic, id) < (timestamptz 'epoch' + $6::bigint * interval '1 microsecond', $7::text, $8::text))
  ORDER BY started DESC, clinic DESC, id DESC LIMIT $9::bigint
)
SELECT json_build_object('sessions', coalesce(json_agg(json_build_object('clinic', s.clinic, 'id', s.id, 'rig', s.rig,
    'protocol', s.protocol, 'subject', s.subject, 'label', s.label, 'state', s.state,
    'started_ms', (extract(epoch FROM s.started) * 1000)::bigint, 'duration_s', p.duration_s, 'planned_trials', s.planned_trials,
    'valid_trials', p.valid_trials, 'lost_scans', p.lost_scans, 'parts', p.parts, 'stored_parts', p.stored_parts)
    ORDER BY s.started DESC, s.clinic DESC, s.id DESC), '[]'),
  'next', CASE WHEN count(*) = $9::bigint THEN (array_agg((extract(epoch FROM s.started) * 1000000)::bigint || ',' || s.clinic || ',' || s.id
    ORDER BY s.started, s.clinic, s.id))[1] END)
FROM page s CROSS JOIN LATERAL (
  SELECT sum(duration_s) FILTER (WHERE leading_part = 0) AS duration_s, sum(valid_trials) AS valid_trials,
    sum(lost_scans) AS lost_scans, count(*) AS parts, count(store_key) AS stored_parts FROM part WHERE part.clinic = s.clinic AND part.session = s.id) p)sql";
  const auto& before = filter.before;
  return only_cell(
      database.run(kSql, {filter.clinic, filter.rig, filter.protocol, filter.subject, filter.since_ms,
                          before ? std::optional(before->started_us) : std::nullopt, before ? std::optional(before->clinic) : std::nullopt,
                          before ? std::optional(before->id) : std::nullopt, filter.limit}));
}

core::Result<std::string> measures_page(Database& database) {
  // A clinic chooses these names: the limits end the recursion, too. Each step of the recursion finds the next name in the index. Only the
  // count reads more, and only the index.
  static const std::string kSql = R"sql(
WITH RECURSIVE measure AS (
  (SELECT name, analysis FROM result WHERE started IS NOT NULL ORDER BY name, analysis LIMIT 1)
  UNION ALL
  SELECT n.* FROM measure m CROSS JOIN LATERAL (SELECT name, analysis FROM result
    WHERE started IS NOT NULL AND (name, analysis) > (m.name, m.analysis) ORDER BY name, analysis LIMIT 1) n
), some_measures AS (
  SELECT * FROM measure LIMIT $1
), protocol AS (
  (SELECT protocol FROM session ORDER BY protocol LIMIT 1)
  UNION ALL
  SELECT n.* FROM protocol p CROSS JOIN LATERAL (SELECT protocol FROM session WHERE protocol > p.protocol ORDER BY protocol LIMIT 1) n
)
SELECT json_build_object('measures', (SELECT coalesce(json_agg(json_build_object('name', name, 'analysis', analysis,
    'unit', (SELECT unit FROM result r WHERE r.name = m.name AND r.analysis = m.analysis AND started IS NOT NULL LIMIT 1),
    'count', (SELECT count(*) FROM result r WHERE r.name = m.name AND r.analysis = m.analysis AND started IS NOT NULL))
    ORDER BY name, analysis), '[]') FROM some_measures m),
  'protocols', (SELECT coalesce(json_agg(protocol ORDER BY protocol), '[]') FROM (SELECT * FROM protocol LIMIT $2) some_protocols)))sql";
  return database.transaction([&]() -> core::Result<std::string> {
    DTS_TRY(database.run_script("SET LOCAL statement_timeout = '30s'"));  // the answer is kept for minutes
    return only_cell(database.run(kSql, {kMostMeasures, kMostProtocols}));
  });
}

core::Result<std::string> trend_page(Database& database, const TrendFilter& filter) {
  static const std::string kSql = R"sql(
SELECT json_build_object('points', coalesce(json_agg(json_build_array(t.clinic, t.week_ms, t.count, t.quartiles[1], t.quartiles[2],
  t.quartiles[3]) ORDER BY t.clinic, t.week_ms), '[]'))
FROM (
  SELECT clinic, (extract(epoch FROM week) * 1000)::bigint AS week_ms, count(*) AS count,
    percentile_cont(ARRAY[0.25, 0.5, 0.75]) WITHIN GROUP (ORDER BY value) AS quartiles
  FROM result WHERE name = $1 AND analysis = $2 AND started IS NOT NULL AND ($3 = '' OR protocol = $3) AND ($4 = '' OR clinic = $4)
    AND ($5::bigint IS NULL OR week >= week_of(to_timestamp($5::bigint / 1000.0)))
  GROUP BY clinic, week) t)sql";
  return only_cell(database.run(kSql, {filter.measure, filter.analysis, filter.protocol, filter.clinic, filter.since_ms}));
}

}  // namespace dts::fleet::desk
