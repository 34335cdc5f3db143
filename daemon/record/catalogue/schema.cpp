// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/schema.h"

#include <array>
#include <string>

namespace dts::record {
namespace {

/// `state` of parts is PartState. No table is needed to read a recording: if a file and a row differ, the file is right.
constexpr const char* kVersion1 = R"sql(
CREATE TABLE subjects (
  id INTEGER PRIMARY KEY,
  pseudonym TEXT NOT NULL UNIQUE
) STRICT;

CREATE TABLE protocols (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  sha256 TEXT NOT NULL,       -- of the definition
  definition TEXT NOT NULL,
  UNIQUE (name, sha256)
) STRICT;

CREATE TABLE calibrations (
  id TEXT PRIMARY KEY,
  rig TEXT NOT NULL,
  kind TEXT NOT NULL,
  definition TEXT NOT NULL
) STRICT;

CREATE TABLE sessions (
  id TEXT PRIMARY KEY,
  rig TEXT NOT NULL,
  protocol_id INTEGER NOT NULL REFERENCES protocols (id),
  subject_id INTEGER REFERENCES subjects (id),
  label TEXT NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('running', 'complete', 'incomplete', 'interrupted', 'aborted')),
  message TEXT NOT NULL,
  started_utc_ns INTEGER NOT NULL,
  ended_utc_ns INTEGER NOT NULL
) STRICT;
CREATE INDEX sessions_by_start ON sessions (started_utc_ns);
CREATE INDEX sessions_by_subject ON sessions (subject_id);

CREATE TABLE parts (
  session_id TEXT NOT NULL REFERENCES sessions (id),
  part INTEGER NOT NULL CHECK (part >= 1),
  file TEXT NOT NULL,
  state INTEGER NOT NULL CHECK (state BETWEEN 1 AND 6),
  sha256 TEXT NOT NULL,
  bytes INTEGER NOT NULL CHECK (bytes >= 0),
  scans INTEGER NOT NULL CHECK (scans >= 0),
  duration_s REAL NOT NULL,
  lost_s_at_most REAL NOT NULL,
  reason TEXT NOT NULL,
  started_utc_ns INTEGER NOT NULL,
  calibration_id TEXT NOT NULL,  -- no reference: recordings outlive what is entered here
  PRIMARY KEY (session_id, part)
) STRICT;

CREATE TABLE trials (
  session_id TEXT NOT NULL,
  part INTEGER NOT NULL,
  trial INTEGER NOT NULL CHECK (trial >= 1),
  attempt INTEGER NOT NULL CHECK (attempt >= 1),
  block INTEGER NOT NULL,
  condition TEXT NOT NULL,
  outcome TEXT NOT NULL CHECK (outcome IN ('done', 'redone', 'rejected', 'aborted')),
  segment INTEGER NOT NULL CHECK (segment >= 0),
  first_scan INTEGER NOT NULL CHECK (first_scan >= 0),
  last_segment INTEGER NOT NULL CHECK (last_segment >= segment),
  last_scan INTEGER NOT NULL CHECK (last_scan >= 0),
  PRIMARY KEY (session_id, part, trial, attempt),
  FOREIGN KEY (session_id, part) REFERENCES parts (session_id, part)
) STRICT;

CREATE TABLE results (
  session_id TEXT NOT NULL REFERENCES sessions (id),
  name TEXT NOT NULL,
  value REAL NOT NULL,
  unit TEXT NOT NULL,
  details TEXT NOT NULL,
  PRIMARY KEY (session_id, name)
) STRICT;

CREATE TABLE audit (
  number INTEGER PRIMARY KEY,
  utc_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  what TEXT NOT NULL,
  target TEXT NOT NULL,
  result TEXT NOT NULL,
  hash TEXT NOT NULL
) STRICT;
-- Against mistakes; against intent there is the chain (audit_trail.h). INSERT OR REPLACE deletes without asking the trigger for deletes.
CREATE TRIGGER audit_is_not_changed BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'the audit trail is append-only'); END;
CREATE TRIGGER audit_is_not_deleted BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'the audit trail is append-only'); END;
CREATE TRIGGER audit_is_only_continued BEFORE INSERT ON audit
  WHEN NEW.number IS NOT (SELECT COALESCE(MAX(number), 0) + 1 FROM audit)
  BEGIN SELECT RAISE(ABORT, 'the audit trail is append-only'); END;
)sql";

/// Result of a trial of the reaching task: its event "result" as JSON; empty: no result.
constexpr const char* kVersion2 = "ALTER TABLE trials ADD COLUMN result TEXT NOT NULL DEFAULT '';";

/// Scans missing between a part's first scan and its last, see record/losses.h.
constexpr const char* kVersion3 = "ALTER TABLE parts ADD COLUMN losses TEXT NOT NULL DEFAULT '{}';";

/// Whether a trial is valid, see `is_valid` in catalogue.h.
constexpr const char* kVersion4 = R"sql(
ALTER TABLE trials ADD COLUMN is_valid INTEGER NOT NULL DEFAULT 0 CHECK (is_valid IN (0, 1));
UPDATE trials SET is_valid = 1 WHERE outcome = 'done' AND
  CASE WHEN json_valid(result) AND json_extract(result, '$.event') = 'sway' THEN json_extract(result, '$.is_valid') IS 1 ELSE 1 END;
)sql";

/// An empty `losses` means "not known". Version 3 set "{}" for parts whose files it had not read, and kept their durations without gaps.
/// `rebuild` reads these files again.
constexpr const char* kVersion5 = "UPDATE parts SET losses = '' WHERE losses = '{}';";

/// New rows hold the result of a trial as JSON of `dts.v1.Event`. Earlier rows stay as they are: `event_of_text` reads both. The version
/// keeps an older dtsd, which would show no result, from opening this catalogue.
constexpr const char* kVersion6 = "SELECT 1;";

/// What people corrected, see corrections.h. The other columns stay as recorded; NULL means not corrected.
constexpr const char* kVersion7 = R"sql(
ALTER TABLE sessions ADD COLUMN corrected_subject TEXT;
ALTER TABLE sessions ADD COLUMN corrected_label TEXT;
ALTER TABLE sessions ADD COLUMN notes TEXT NOT NULL DEFAULT '';
ALTER TABLE sessions ADD COLUMN is_deleted INTEGER NOT NULL DEFAULT 0 CHECK (is_deleted IN (0, 1));
ALTER TABLE trials ADD COLUMN corrected_outcome TEXT CHECK (corrected_outcome IN ('done', 'redone', 'rejected', 'aborted'));

CREATE TABLE corrections (
  session_id TEXT NOT NULL REFERENCES sessions (id),
  number INTEGER NOT NULL CHECK (number >= 1),
  utc_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  field INTEGER NOT NULL CHECK (field BETWEEN 1 AND 5),  -- CorrectedField
  part INTEGER NOT NULL CHECK (part >= 0),
  trial INTEGER NOT NULL CHECK (trial >= 0),
  attempt INTEGER NOT NULL CHECK (attempt >= 0),
  old_value TEXT NOT NULL,
  new_value TEXT NOT NULL,
  reason TEXT NOT NULL,
  PRIMARY KEY (session_id, number)
) STRICT;
)sql";

/// Whether trials are valid was decided by other rules before. NULL means "not decided": `Catalogue::open` decides it by `is_valid`.
constexpr const char* kVersion8 = R"sql(
ALTER TABLE trials DROP COLUMN is_valid;
ALTER TABLE trials ADD COLUMN is_valid INTEGER CHECK (is_valid IN (0, 1));
)sql";

/// The newest attempt of each trial that has begun: also one that is under way, or that an undo took back. Rows of `trials` are attempts
/// that have ended. Markers, and their corrections. `rebuild` reads the recordings of earlier parts again for the attempts and the markers.
constexpr const char* kVersion9 = R"sql(
CREATE TABLE begun_attempts (
  session_id TEXT NOT NULL REFERENCES sessions (id),
  trial INTEGER NOT NULL CHECK (trial >= 1),
  newest INTEGER NOT NULL CHECK (newest >= 1),
  PRIMARY KEY (session_id, trial)
) STRICT;

-- Markers as recorded; a text that a person removed is empty.
CREATE TABLE markers (
  session_id TEXT NOT NULL,
  part INTEGER NOT NULL,
  number INTEGER NOT NULL CHECK (number >= 1),  -- in the recording of this part
  segment INTEGER NOT NULL CHECK (segment >= 0),
  scan INTEGER NOT NULL CHECK (scan >= 0),
  text TEXT NOT NULL,
  PRIMARY KEY (session_id, part, number),
  FOREIGN KEY (session_id, part) REFERENCES parts (session_id, part)
) STRICT;

-- SQLite cannot change a CHECK: the table is made again.
ALTER TABLE corrections RENAME TO corrections_before;
CREATE TABLE corrections (
  session_id TEXT NOT NULL REFERENCES sessions (id),
  number INTEGER NOT NULL CHECK (number >= 1),
  utc_ns INTEGER NOT NULL,
  who TEXT NOT NULL,
  field INTEGER NOT NULL CHECK (field BETWEEN 1 AND 6),  -- CorrectedField
  part INTEGER NOT NULL CHECK (part >= 0),
  trial INTEGER NOT NULL CHECK (trial >= 0),
  attempt INTEGER NOT NULL CHECK (attempt >= 0),
  marker INTEGER NOT NULL CHECK (marker >= 0),
  old_value TEXT NOT NULL,
  new_value TEXT NOT NULL,
  reason TEXT NOT NULL,
  PRIMARY KEY (session_id, number)
) STRICT;
INSERT INTO corrections SELECT session_id, number, utc_ns, who, field, part, trial, attempt, 0, old_value, new_value, reason
  FROM corrections_before;
DROP TABLE corrections_before;

ALTER TABLE parts ADD COLUMN has_events INTEGER NOT NULL DEFAULT 0 CHECK (has_events IN (0, 1));  -- attempts and markers are entered
)sql";

/// Parts of several rigs in one session. Earlier sessions have one rig.
constexpr const char* kVersion10 = R"sql(
ALTER TABLE parts ADD COLUMN rig TEXT NOT NULL DEFAULT '';
ALTER TABLE parts ADD COLUMN leading_part INTEGER NOT NULL DEFAULT 0 CHECK (leading_part >= 0);
UPDATE parts SET leading_part = part, rig = (SELECT rig FROM sessions WHERE id = session_id);
)sql";

constexpr std::array<const char*, 10> kMigrations{kVersion1, kVersion2, kVersion3, kVersion4, kVersion5,
                                                  kVersion6, kVersion7, kVersion8, kVersion9, kVersion10};

core::Status check_owner(const Database& database, std::int64_t version) {
  const auto mark = database.number("PRAGMA application_id");
  if (mark == kCatalogueMark) return {};
  if (mark == 0 && version == 0 && database.number("SELECT count(*) FROM sqlite_schema") == 0) return {};  // a new file
  return core::fail(core::ErrorCode::WrongState, database.file() + " is no catalogue of dtsd but a database of another program",
                    "move it away, or choose another folder: directory under [storage] in dtsd.toml");
}

void apply(const Database& database, const char* migration, std::size_t version) {
  Transaction transaction(database);
  database.execute(migration);
  // PRAGMA statements cannot have bound values. The numbers are safe: they are from this program, not from a caller.
  database.execute("PRAGMA application_id = " + std::to_string(kCatalogueMark) + "; PRAGMA user_version = " + std::to_string(version));
  transaction.commit();
}

}  // namespace

std::span<const char* const> catalogue_migrations() noexcept { return kMigrations; }

core::Status migrate(const Database& database, std::span<const char* const> migrations) try {
  const auto version = database.number("PRAGMA user_version");
  if (auto ours = check_owner(database, version); !ours) return ours;
  if (version < 0 || static_cast<std::uint64_t>(version) > migrations.size()) {
    return core::fail(core::ErrorCode::Unsupported,
                      "the catalogue " + database.file() + " has version " + std::to_string(version) + ", this dtsd knows up to " +
                          std::to_string(migrations.size()),
                      "install the newer dtsd again; it is not changed by this one");
  }
  for (auto done = static_cast<std::size_t>(version); done < migrations.size(); ++done) apply(database, migrations[done], done + 1);
  return {};
} catch (const SQLite::Exception& exception) {
  return database.failure(exception);
}

}  // namespace dts::record
