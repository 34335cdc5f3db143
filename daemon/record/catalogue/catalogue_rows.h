// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/catalogue.h"
#include "record/catalogue/sqlite.h"

namespace dts::record {

/// Returns all rows; `read` converts each row to a value.
template <class Read>
[[nodiscard]] auto rows_of(Statement rows, const Read& read) {
  std::vector<decltype(read(rows))> all;
  while (rows.step()) all.push_back(read(rows));
  return all;
}

inline constexpr const char* kSessionColumns =
    "SELECT sessions.id, sessions.rig, protocols.name, COALESCE(sessions.corrected_subject, subjects.pseudonym, '') AS shown_subject,"
    " COALESCE(sessions.corrected_label, sessions.label), sessions.state, sessions.message, sessions.started_utc_ns,"
    " sessions.ended_utc_ns, protocols.definition, COALESCE(subjects.pseudonym, ''), sessions.label, sessions.notes, sessions.is_deleted"
    " FROM sessions JOIN protocols ON protocols.id = sessions.protocol_id"
    " LEFT JOIN subjects ON subjects.id = sessions.subject_id ";
inline constexpr const char* kPartColumns =
    "SELECT session_id, part, file, state, sha256, bytes, scans, duration_s, lost_s_at_most, reason, started_utc_ns, losses,"
    " (SELECT count(*) FROM trials WHERE trials.session_id = parts.session_id AND trials.part = parts.part AND trials.is_valid = 1),"
    " rig, leading_part FROM parts ";
inline constexpr const char* kTrialColumns =
    "SELECT session_id, part, trial, attempt, block, condition, COALESCE(corrected_outcome, outcome), segment, first_scan, last_scan,"
    " last_segment, result, CASE WHEN corrected_outcome IS NULL THEN '' ELSE outcome END FROM trials ";
inline constexpr const char* kCorrectionColumns =
    "SELECT number, utc_ns, who, field, part, trial, attempt, marker, old_value, new_value, reason FROM corrections ";
inline constexpr const char* kMarkerColumns = "SELECT session_id, part, number, segment, scan, text FROM markers ";

[[nodiscard]] SessionRow read_session(Statement& row);  ///< Reads `kSessionColumns`; leaves parts and trials empty.
[[nodiscard]] PartRow read_part(Statement& row);
[[nodiscard]] TrialRow read_trial(Statement& row);
[[nodiscard]] Correction read_correction(Statement& row);
[[nodiscard]] MarkerRow read_marker(Statement& row);
[[nodiscard]] SubjectRow read_subject(Statement& row);  ///< subject, sessions, deleted ones, first and last start, bytes
[[nodiscard]] ResultRow read_result(Statement& row);    ///< session_id, name, value, unit, details

}  // namespace dts::record
