// SPDX-License-Identifier: Apache-2.0
#include "fleet/database/schema.h"

#include <array>
#include <string>

namespace dts::fleet::database {
namespace {

/// The statements of one version. Later versions are added, never changed: databases with the older ones exist.
constexpr std::array<const char*, kSchemaVersion> kVersions = {R"sql(
CREATE TABLE clinic (
  id text PRIMARY KEY CHECK (id ~ '^[a-z0-9-]{1,32}$'),
  title text NOT NULL,
  nkey text NOT NULL UNIQUE,
  state text NOT NULL DEFAULT 'active' CHECK (state IN ('active', 'revoked')),
  added timestamptz NOT NULL DEFAULT now(),
  revoked timestamptz
);

-- What a clinic reports every 10 s: the newest, and one row a day.
CREATE TABLE beat (
  clinic text PRIMARY KEY,
  at timestamptz NOT NULL,
  clock_offset_s double precision NOT NULL,  -- the clinic's clock minus the hub's
  forwarder_version text NOT NULL,
  has_daemon boolean NOT NULL,
  daemon_version text NOT NULL,
  disk_state text NOT NULL,
  disk_free_bytes bigint NOT NULL,
  recordable_s double precision NOT NULL,
  backlog_files bigint NOT NULL,
  backlog_bytes bigint NOT NULL,
  backlog_oldest timestamptz,
  last_receipt timestamptz,
  held_files bigint NOT NULL
) WITH (fillfactor = 50);
CREATE TABLE beat_history (
  clinic text,
  day date,
  beats bigint NOT NULL,
  first_at timestamptz NOT NULL,
  last_at timestamptz NOT NULL,
  largest_clock_offset_s double precision NOT NULL,
  largest_backlog_bytes bigint NOT NULL,
  least_disk_free_bytes bigint NOT NULL,
  PRIMARY KEY (clinic, day)
) WITH (fillfactor = 50);
CREATE TABLE rig (
  clinic text,
  id text,
  kind text NOT NULL,
  sensors bigint NOT NULL,
  device text NOT NULL,
  nominal_rate_hz double precision NOT NULL,
  measured_rate_hz double precision,
  scans_total bigint NOT NULL,
  lost_scans_total bigint NOT NULL,
  gaps_total bigint NOT NULL,
  session_state text NOT NULL,
  session text NOT NULL,
  calibration text NOT NULL,
  calibration_since timestamptz NOT NULL,  -- when this calibration was first reported
  streams text[] NOT NULL,
  at timestamptz NOT NULL,
  PRIMARY KEY (clinic, id)
) WITH (fillfactor = 50);

CREATE TABLE session (
  clinic text,
  id text,
  revision bigint NOT NULL,
  rig text NOT NULL,
  protocol text NOT NULL,
  subject text,
  state text NOT NULL,
  started timestamptz NOT NULL,
  ended timestamptz,
  planned_trials bigint NOT NULL,
  is_deleted boolean NOT NULL,
  label text,
  notes text,
  fields jsonb NOT NULL,
  received timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (clinic, id)
);
CREATE INDEX session_started ON session (started DESC);
CREATE INDEX session_clinic_started ON session (clinic, started DESC);
CREATE INDEX session_protocol_started ON session (protocol, started DESC);
CREATE INDEX session_rig_started ON session (rig, started DESC);
CREATE INDEX session_subject ON session (subject, started DESC) WHERE subject IS NOT NULL;

-- A part may arrive before its session, and the facts of a part before its recording: store_key is set once the recording is stored.
CREATE TABLE part (
  clinic text,
  session text,
  part bigint,
  sha256 bytea CHECK (octet_length(sha256) = 32),
  recorded_sha256 bytea CHECK (octet_length(recorded_sha256) = 32),
  bytes bigint NOT NULL,
  state text,
  scans bigint,
  duration_s double precision,
  lost_scans bigint,
  is_loss_unknown boolean,
  valid_trials bigint,
  stored_utc timestamptz,
  store_key text,
  PRIMARY KEY (clinic, session, part),
  UNIQUE (clinic, sha256)
);
CREATE TABLE trial (
  clinic text,
  session text,
  part bigint,
  trial bigint,
  attempt bigint,
  block bigint NOT NULL,
  condition text NOT NULL,
  outcome text NOT NULL,
  recorded_outcome text NOT NULL,
  fault text NOT NULL,
  PRIMARY KEY (clinic, session, part, trial, attempt),
  FOREIGN KEY (clinic, session) REFERENCES session ON DELETE CASCADE
);
CREATE TABLE result (
  clinic text,
  session text,
  name text,
  analysis text,  -- 'clinic', or the analysis of the centre with its version: 'sway 0.3.1'
  value double precision NOT NULL,
  unit text NOT NULL,
  details jsonb,
  -- Of the session, kept by triggers: the trend of a measure needs only its index, neither this table nor a join. Null: the session is hidden.
  started timestamptz,
  protocol text,
  PRIMARY KEY (clinic, session, name, analysis),
  FOREIGN KEY (clinic, session) REFERENCES session ON DELETE CASCADE
);
CREATE INDEX result_trend ON result (name, analysis, clinic, started) INCLUDE (value, protocol) WHERE started IS NOT NULL;
-- With the rights of the tables' owner: a worker may add results, and may not read sessions.
CREATE FUNCTION place_result() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = public, pg_temp AS $$
BEGIN
  SELECT CASE WHEN NOT s.is_deleted THEN s.started END, s.protocol INTO NEW.started, NEW.protocol
    FROM session s WHERE s.clinic = NEW.clinic AND s.id = NEW.session;
  RETURN NEW;
END $$;
CREATE TRIGGER place_result BEFORE INSERT ON result FOR EACH ROW EXECUTE FUNCTION place_result();
CREATE FUNCTION place_results_again() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  UPDATE result SET started = CASE WHEN NOT NEW.is_deleted THEN NEW.started END, protocol = NEW.protocol
    WHERE clinic = NEW.clinic AND session = NEW.id;
  RETURN NULL;
END $$;
CREATE TRIGGER place_results_again AFTER UPDATE ON session FOR EACH ROW
  WHEN ((OLD.is_deleted, OLD.started, OLD.protocol) IS DISTINCT FROM (NEW.is_deleted, NEW.started, NEW.protocol))
  EXECUTE FUNCTION place_results_again();

CREATE TABLE receipt (
  clinic text,
  sha256 bytea CHECK (octet_length(sha256) = 32),
  bytes bigint NOT NULL,
  session text NOT NULL,
  part bigint NOT NULL,
  stored_utc timestamptz NOT NULL,
  hub text NOT NULL,
  store_key text NOT NULL,
  PRIMARY KEY (clinic, sha256)
);
CREATE INDEX receipt_session ON receipt (clinic, session);
CREATE INDEX receipt_stored ON receipt (stored_utc DESC);
CREATE INDEX receipt_clinic_stored ON receipt (clinic, stored_utc DESC);

-- Sessions that their clinic has erased, which must not appear again, and files of them that are not removed yet.
CREATE TABLE erased (
  clinic text,
  session text,
  at timestamptz NOT NULL DEFAULT now(),
  PRIMARY KEY (clinic, session)
);
CREATE TABLE erased_file (
  clinic text,
  sha256 bytea,
  PRIMARY KEY (clinic, sha256)
);

CREATE TABLE audit (
  number bigint PRIMARY KEY,
  utc_ns bigint NOT NULL,
  who text NOT NULL,
  what text NOT NULL,
  target text NOT NULL,
  result text NOT NULL,
  hash text NOT NULL
);

-- One analysis of one recording. A worker has a running job until lease_until, which it renews; then another takes the job. A waiting job
-- is not taken before lease_until. Each take increases `tries`: worker and tries name one take.
CREATE TABLE job (
  id bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
  kind text NOT NULL,
  version text NOT NULL,
  clinic text NOT NULL,
  session text NOT NULL,
  part bigint NOT NULL,
  state text NOT NULL DEFAULT 'waiting' CHECK (state IN ('waiting', 'running', 'done', 'failed')),
  lease_until timestamptz,
  worker text,
  tries integer NOT NULL DEFAULT 0,
  message text NOT NULL DEFAULT '',
  UNIQUE (clinic, session, part, kind, version)
);
-- In the order in which workers take jobs: without it they read all jobs that are done.
CREATE INDEX job_waiting ON job (version, tries, id) WHERE state IN ('waiting', 'running');

-- Who reads what: README, "Readers". A row without protocol permits all sessions of the clinic.
CREATE TABLE permit (
  role text NOT NULL,
  clinic text NOT NULL,
  protocol text,
  UNIQUE NULLS NOT DISTINCT (role, clinic, protocol)
);

DO $$
BEGIN
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'reader') THEN CREATE ROLE reader NOLOGIN; END IF;
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'subject_reader') THEN CREATE ROLE subject_reader NOLOGIN; END IF;
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'worker') THEN CREATE ROLE worker NOLOGIN; END IF;
END $$;

ALTER TABLE clinic ENABLE ROW LEVEL SECURITY;
ALTER TABLE session ENABLE ROW LEVEL SECURITY;
ALTER TABLE part ENABLE ROW LEVEL SECURITY;
ALTER TABLE trial ENABLE ROW LEVEL SECURITY;
ALTER TABLE result ENABLE ROW LEVEL SECURITY;
ALTER TABLE permit ENABLE ROW LEVEL SECURITY;
CREATE POLICY own ON permit FOR SELECT TO reader USING (role = current_user);
CREATE POLICY permitted ON clinic FOR SELECT TO reader USING (id IN (SELECT clinic FROM permit WHERE role = current_user));
CREATE POLICY whole_clinic ON session FOR SELECT TO reader
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user AND protocol IS NULL));
CREATE POLICY one_protocol ON session FOR SELECT TO reader
  USING ((clinic, protocol) IN (SELECT clinic, protocol FROM permit WHERE role = current_user AND protocol IS NOT NULL));
CREATE POLICY whole_clinic ON part FOR SELECT TO reader
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user AND protocol IS NULL));
CREATE POLICY one_protocol ON part FOR SELECT TO reader USING ((clinic, session) IN (
  SELECT s.clinic, s.id FROM session s JOIN permit p USING (clinic, protocol) WHERE p.role = current_user));
CREATE POLICY whole_clinic ON trial FOR SELECT TO reader
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user AND protocol IS NULL));
CREATE POLICY one_protocol ON trial FOR SELECT TO reader USING ((clinic, session) IN (
  SELECT s.clinic, s.id FROM session s JOIN permit p USING (clinic, protocol) WHERE p.role = current_user));
CREATE POLICY whole_clinic ON result FOR SELECT TO reader
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user AND protocol IS NULL));
CREATE POLICY one_protocol ON result FOR SELECT TO reader USING ((clinic, session) IN (
  SELECT s.clinic, s.id FROM session s JOIN permit p USING (clinic, protocol) WHERE p.role = current_user));

GRANT SELECT ON permit TO reader;
GRANT SELECT (id, title, state) ON clinic TO reader;
GRANT SELECT (clinic, id, rig, protocol, state, started, ended, planned_trials, is_deleted) ON session TO reader;
GRANT SELECT (clinic, session, part, bytes, state, scans, duration_s, lost_scans, is_loss_unknown, valid_trials, stored_utc) ON part TO reader;
GRANT SELECT ON trial, result TO reader;
GRANT SELECT (subject, fields) ON session TO subject_reader;

-- dts-worker: jobs, where recordings are, and results, but never those of a clinic.
CREATE POLICY all_parts ON part FOR SELECT TO worker USING (true);
CREATE POLICY own_analyses ON result TO worker USING (analysis <> 'clinic') WITH CHECK (analysis <> 'clinic');
GRANT SELECT, UPDATE (state, lease_until, worker, tries, message) ON job TO worker;
GRANT SELECT (clinic, session, part, sha256, store_key) ON part TO worker;
GRANT SELECT, INSERT, UPDATE ON result TO worker;

CREATE SCHEMA study;
GRANT USAGE ON SCHEMA study TO reader;
CREATE VIEW study.session WITH (security_invoker = true) AS
  SELECT clinic, id, rig, protocol, state, started, ended, planned_trials FROM session WHERE NOT is_deleted;
CREATE VIEW study.subject WITH (security_invoker = true) AS
  SELECT clinic, id AS session, subject, fields FROM session WHERE NOT is_deleted;
CREATE VIEW study.part WITH (security_invoker = true) AS
  SELECT p.clinic, p.session, p.part, p.bytes, p.state, p.scans, p.duration_s, p.lost_scans, p.is_loss_unknown, p.valid_trials, p.stored_utc
  FROM part p JOIN session s ON s.clinic = p.clinic AND s.id = p.session WHERE NOT s.is_deleted;
CREATE VIEW study.trial WITH (security_invoker = true) AS
  SELECT t.* FROM trial t JOIN session s ON s.clinic = t.clinic AND s.id = t.session WHERE NOT s.is_deleted;
CREATE VIEW study.result WITH (security_invoker = true) AS
  SELECT r.* FROM result r JOIN session s ON s.clinic = r.clinic AND s.id = r.session WHERE NOT s.is_deleted;
GRANT SELECT ON study.session, study.part, study.trial, study.result TO reader;
GRANT SELECT ON study.subject TO subject_reader;
)sql",
                                                               R"sql(
-- How much each clinic has, for its quota. Several rows of a clinic: connections that add to it at the same time seldom wait for each other.
CREATE TABLE row_count (
  clinic text,
  shard bigint,
  sessions bigint NOT NULL DEFAULT 0,
  rows bigint NOT NULL DEFAULT 0,  -- parts, trials and results in the facts of the sessions
  recordings bigint NOT NULL DEFAULT 0,
  erased bigint NOT NULL DEFAULT 0,
  PRIMARY KEY (clinic, shard)
) WITH (fillfactor = 50);
ALTER TABLE session ADD COLUMN rows bigint NOT NULL DEFAULT 0;
CREATE FUNCTION add_to_row_count(clinic text, sessions bigint, rows numeric, recordings bigint, erased bigint)
RETURNS void LANGUAGE sql AS $$
  INSERT INTO row_count AS c VALUES ($1, pg_backend_pid() % 16, $2, $3, $4, $5)
    ON CONFLICT (clinic, shard) DO UPDATE SET sessions = c.sessions + excluded.sessions, rows = c.rows + excluded.rows,
      recordings = c.recordings + excluded.recordings, erased = c.erased + excluded.erased
$$;
CREATE FUNCTION count_session() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    PERFORM add_to_row_count(clinic, count(*), sum(rows), 0, 0) FROM added GROUP BY clinic;
  ELSIF TG_OP = 'DELETE' THEN
    PERFORM add_to_row_count(clinic, -count(*), -sum(rows), 0, 0) FROM removed GROUP BY clinic;
  ELSE
    PERFORM add_to_row_count(clinic, 0, sum(rows), 0, 0) FROM
      (SELECT clinic, rows FROM added UNION ALL SELECT clinic, -rows FROM removed) change GROUP BY clinic HAVING sum(rows) <> 0;
  END IF;
  RETURN NULL;
END $$;
CREATE FUNCTION count_recording() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  IF TG_OP = 'INSERT' THEN
    PERFORM add_to_row_count(clinic, 0, 0, count(*), 0) FROM added GROUP BY clinic;
  ELSE
    PERFORM add_to_row_count(clinic, 0, 0, -count(*), 0) FROM removed GROUP BY clinic;
  END IF;
  RETURN NULL;
END $$;
CREATE FUNCTION count_erased() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  PERFORM add_to_row_count(clinic, 0, 0, 0, count(*)) FROM added GROUP BY clinic;
  RETURN NULL;
END $$;
CREATE TRIGGER count_added AFTER INSERT ON session REFERENCING NEW TABLE AS added FOR EACH STATEMENT EXECUTE FUNCTION count_session();
CREATE TRIGGER count_changed AFTER UPDATE ON session REFERENCING OLD TABLE AS removed NEW TABLE AS added
  FOR EACH STATEMENT EXECUTE FUNCTION count_session();
CREATE TRIGGER count_removed AFTER DELETE ON session REFERENCING OLD TABLE AS removed FOR EACH STATEMENT EXECUTE FUNCTION count_session();
CREATE TRIGGER count_added AFTER INSERT ON receipt REFERENCING NEW TABLE AS added FOR EACH STATEMENT EXECUTE FUNCTION count_recording();
CREATE TRIGGER count_removed AFTER DELETE ON receipt REFERENCING OLD TABLE AS removed
  FOR EACH STATEMENT EXECUTE FUNCTION count_recording();
CREATE TRIGGER count_added AFTER INSERT ON erased REFERENCING NEW TABLE AS added FOR EACH STATEMENT EXECUTE FUNCTION count_erased();
INSERT INTO row_count (clinic, shard, sessions, recordings, erased)
  SELECT clinic, 0, sum(s), sum(r), sum(e) FROM (
    SELECT clinic, 1 AS s, 0 AS r, 0 AS e FROM session UNION ALL SELECT clinic, 0, 1, 0 FROM receipt
    UNION ALL SELECT clinic, 0, 0, 1 FROM erased) known GROUP BY clinic;

-- The Monday (UTC) of a result, so that a trend reads groups that are complete in the index: neither a sort nor a time zone for each row.
CREATE FUNCTION week_of(started timestamptz) RETURNS date LANGUAGE sql IMMUTABLE AS $$
  SELECT date_trunc('week', started AT TIME ZONE 'UTC')::date
$$;
DROP INDEX result_trend;
ALTER TABLE result ADD COLUMN week date;
UPDATE result SET week = week_of(started) WHERE started IS NOT NULL;
CREATE INDEX result_trend ON result (name, analysis, clinic, week) INCLUDE (value, protocol) WHERE started IS NOT NULL;
-- The session's row is locked: a session that is hidden or corrected at the same time would leave its old start and protocol in the result.
CREATE OR REPLACE FUNCTION place_result() RETURNS trigger LANGUAGE plpgsql SECURITY DEFINER SET search_path = public, pg_temp AS $$
BEGIN
  SELECT CASE WHEN NOT s.is_deleted THEN s.started END, s.protocol INTO NEW.started, NEW.protocol
    FROM session s WHERE s.clinic = NEW.clinic AND s.id = NEW.session FOR SHARE;
  NEW.week := week_of(NEW.started);
  RETURN NEW;
END $$;
-- The hub, which has the session's row, states the start of the clinic's own results. That halves the time of an insert.
DROP TRIGGER place_result ON result;
CREATE TRIGGER place_result BEFORE INSERT ON result FOR EACH ROW WHEN (NEW.started IS NULL OR NEW.analysis <> 'clinic')
  EXECUTE FUNCTION place_result();
CREATE OR REPLACE FUNCTION place_results_again() RETURNS trigger LANGUAGE plpgsql AS $$
BEGIN
  UPDATE result SET started = CASE WHEN NOT NEW.is_deleted THEN NEW.started END, protocol = NEW.protocol,
      week = CASE WHEN NOT NEW.is_deleted THEN week_of(NEW.started) END
    WHERE clinic = NEW.clinic AND session = NEW.id;
  RETURN NULL;
END $$;
)sql",
                                                               R"sql(
-- dts-fleet-gateway: reads what the dashboard shows. "dashboard" sees all clinics, "study_dashboard" those in the table permit.
DO $$
BEGIN
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'dashboard') THEN CREATE ROLE dashboard NOLOGIN; END IF;
  IF NOT EXISTS (SELECT FROM pg_roles WHERE rolname = 'study_dashboard') THEN CREATE ROLE study_dashboard NOLOGIN; END IF;
END $$;
GRANT SELECT ON beat, beat_history, rig, result TO dashboard, study_dashboard;
GRANT SELECT (id, title, state) ON clinic TO dashboard, study_dashboard;
GRANT SELECT (clinic, id, rig, protocol, subject, label, state, started, ended, planned_trials, is_deleted) ON session
  TO dashboard, study_dashboard;
GRANT SELECT (clinic, session, part, duration_s, lost_scans, valid_trials, store_key) ON part TO dashboard, study_dashboard;
GRANT SELECT (clinic, sha256, bytes, session, part, stored_utc, hub) ON receipt TO dashboard, study_dashboard;
GRANT SELECT ON permit TO study_dashboard;

ALTER TABLE beat ENABLE ROW LEVEL SECURITY;
ALTER TABLE beat_history ENABLE ROW LEVEL SECURITY;
ALTER TABLE rig ENABLE ROW LEVEL SECURITY;
ALTER TABLE receipt ENABLE ROW LEVEL SECURITY;
CREATE POLICY all_rows ON clinic FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON beat FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON beat_history FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON rig FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON session FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON part FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON result FOR SELECT TO dashboard USING (true);
CREATE POLICY all_rows ON receipt FOR SELECT TO dashboard USING (true);
ALTER POLICY own ON permit TO reader, study_dashboard;
ALTER POLICY permitted ON clinic TO reader, study_dashboard;
ALTER POLICY whole_clinic ON session TO reader, study_dashboard;
ALTER POLICY one_protocol ON session TO reader, study_dashboard;
ALTER POLICY whole_clinic ON part TO reader, study_dashboard;
ALTER POLICY one_protocol ON part TO reader, study_dashboard;
ALTER POLICY whole_clinic ON result TO reader, study_dashboard;
-- By the result's own column, without a join with all sessions.
CREATE POLICY one_protocol_in_result ON result FOR SELECT TO study_dashboard
  USING ((clinic, protocol) IN (SELECT clinic, protocol FROM permit WHERE role = current_user AND protocol IS NOT NULL));
CREATE POLICY permitted ON beat FOR SELECT TO study_dashboard USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user));
CREATE POLICY permitted ON beat_history FOR SELECT TO study_dashboard
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user));
CREATE POLICY permitted ON rig FOR SELECT TO study_dashboard USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user));
CREATE POLICY whole_clinic ON receipt FOR SELECT TO study_dashboard
  USING (clinic IN (SELECT clinic FROM permit WHERE role = current_user AND protocol IS NULL));
CREATE POLICY one_protocol ON receipt FOR SELECT TO study_dashboard USING ((clinic, session) IN (
  SELECT s.clinic, s.id FROM session s JOIN permit p USING (clinic, protocol) WHERE p.role = current_user));
)sql",
                                                               R"sql(
-- Sessions over several rigs: a part with a leading_part was recorded at the same time as that part, which has the trials of both.
ALTER TABLE part ADD rig text, ADD leading_part bigint NOT NULL DEFAULT 0;
GRANT SELECT (rig, leading_part) ON part TO reader, dashboard, study_dashboard;
)sql"};

constexpr const char* kStart =
    "SET LOCAL statement_timeout = 0; SET LOCAL lock_timeout = 0; SELECT pg_advisory_xact_lock(7303561); "
    "CREATE TABLE IF NOT EXISTS schema_version (version bigint PRIMARY KEY, applied timestamptz NOT NULL DEFAULT now())";

/// Applies the next version. Returns false if there is none.
core::Result<bool> migrate_once(Database& database) {
  DTS_TRY(database.run_script(kStart));
  DTS_TRY_ASSIGN(const Rows rows, database.run("SELECT coalesce(max(version), 0) FROM schema_version"));
  DTS_TRY_ASSIGN(const std::int64_t version, rows.integer(0, 0));
  if (version > kSchemaVersion) {
    return core::fail(
        core::ErrorCode::Unsupported,
        "the database has tables of version " + std::to_string(version) + ", this dts-hub knows version " + std::to_string(kSchemaVersion),
        "install the newer dts-hub again");
  }
  if (version == kSchemaVersion) return false;
  DTS_TRY(database.run_script(kVersions.at(static_cast<std::size_t>(version))));
  DTS_TRY(database.run("INSERT INTO schema_version (version) VALUES ($1)", {version + 1}));
  return true;
}

}  // namespace

core::Status migrate(Database& database) {
  while (true) {
    auto applied = database.transaction([&] { return migrate_once(database); });
    if (!applied && applied.error().code == core::ErrorCode::NotAllowed) {
      applied.error().hint =
          "let the database's user create roles and schemas: ALTER ROLE \"dts-hub\" CREATEROLE, and make it the owner of the database";
    }
    DTS_TRY(applied);
    if (!*applied) return {};
  }
}

}  // namespace dts::fleet::database
