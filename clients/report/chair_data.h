// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "classifier/trunk_model.h"
#include "core/result.h"
#include "physics/body/person.h"
#include "report/session_info.h"
#include "report/transient_trace.h"
#include "session/reach_summary.h"
#include "session/recorded_reaches.h"

namespace dts::report {

/// One attempt of a reaching trial.
struct ChairTrial {
  session::RecordedReachTrial recorded;
  std::string recorded_outcome{};          ///< If the outcome was corrected: as recorded.
  std::size_t part = 0;                    ///< Index into `SessionInfo::parts`.
  std::optional<std::int64_t> cue_utc_ns;  ///< Time of the cue.
  TransientTrace trace;                    ///< From shortly before the cue to the end of the trial.
  std::string page;                        ///< "trial-03": unique within the session.
  double raw_rate_hz = 0.0;                ///< Of the scans of cue, P1, P2 and P3.

  /// Returns whether the trial is done, and neither redone nor rejected.
  [[nodiscard]] bool is_kept() const { return recorded.outcome == "done" && recorded.result.has_value(); }
  /// Returns whether the trial counts, by the rule of the catalogue and of the FHIR export: `record::is_valid`.
  [[nodiscard]] bool is_valid() const;
  /// Returns whether the trial is kept and has a reach.
  [[nodiscard]] bool counts() const { return is_kept() && recorded.result->reach && !recorded.result->has_gap; }
  [[nodiscard]] const core::ReachEvent* reach() const {
    return recorded.result && recorded.result->reach ? &*recorded.result->reach : nullptr;
  }
  [[nodiscard]] const core::TrunkMovement* movement() const {
    return recorded.result && recorded.result->movement ? &*recorded.result->movement : nullptr;
  }
  /// Returns whether the class is on the subject's own scale.
  [[nodiscard]] bool is_calibrated() const { return movement() != nullptr && (movement()->reasons & core::class_reason::kCalibrated) != 0; }
  /// Returns the time of a scan after the cue, s.
  [[nodiscard]] double after_cue_s(core::ScanIndex scan) const {
    return (static_cast<double>(scan.value) - static_cast<double>(recorded.go.value)) / raw_rate_hz;
  }
  /// Returns "3", "3, attempt 2".
  [[nodiscard]] std::string number() const;
};

/// All data of a session of the reaching task that a report shows.
struct ChairData : SessionInfo {
  std::vector<ChairTrial> trials;                       ///< In the order of the recording.
  std::optional<classifier::TrunkModel> model{};        ///< As recorded.
  std::optional<physics::Person> person{};              ///< Absent: not all measures of the body are known.
  std::optional<classifier::SubjectCalibration> scale;  ///< The subject's own.
  std::size_t scale_part = 0;                           ///< Index of the part from whose reaches the scale is.
  std::vector<session::TargetSummary> targets;          ///< Of the valid trials.
  std::vector<session::SessionFigure> summary;
  std::uint64_t reaches = 0;                   ///< Found in the whole session, inside or outside trials.
  std::uint64_t compared = 0;                  ///< Trials with results that the daemon recorded.
  std::uint64_t differing = 0;                 ///< How many of them differ from what is computed now.
  std::vector<std::string> differing_results;  ///< Names of results of the session that differ.
};

/// Reads a chair's session and computes its results again. Fails as `make_report`.
[[nodiscard]] core::Result<ChairData> read_chair_session(const ReportSource& source, const ReportProgress& progress);

}  // namespace dts::report
