// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "posturography/analysis.h"
#include "posturography/prepare.h"
#include "posturography/spectrum.h"
#include "report/report.h"
#include "report/session_info.h"
#include "report/stabilogram.h"
#include "session/recorded_sway.h"
#include "session/standing_load.h"

namespace dts::report {

/// A trial and its new analysis.
struct TrialData {
  session::StandingTrial recorded;
  std::string recorded_outcome{};             ///< If the outcome was corrected: as recorded.
  std::size_t part = 0;                       ///< Index into `SessionData::parts`.
  std::optional<std::int64_t> begins_utc_ns;  ///< Start of the part that counts.
  std::optional<posturography::Prepared> prepared;
  posturography::Spectra spectra;
  std::optional<posturography::Analysis> analysis;
  std::string problem;                 ///< Why there is no analysis.
  std::vector<std::string> differing;  ///< Symbols of values that differ from those that the daemon recorded.
  std::string page;                    ///< "trial-03": unique within the session.

  /// Returns whether the trial is done, and neither redone nor rejected; always true for a recording without trials.
  [[nodiscard]] bool is_kept() const { return recorded.trial == 0 ? recorded.counts() : recorded.outcome == "done"; }
  [[nodiscard]] bool counts() const { return is_kept() && analysis && analysis->is_valid(); }
  [[nodiscard]] std::string label(const std::string& name) const;
  /// Returns "3", "3, attempt 2"; "standing 1" for a recording without trials.
  [[nodiscard]] std::string number() const;
};

/// All data of a session of quiet standing that a report shows.
struct SessionData : SessionInfo {
  std::vector<TrialData> trials;  ///< In the order of the recording.
  std::vector<session::SessionFigure> summary;
  std::vector<session::MissingQuotient> missing_quotients;
  std::vector<std::string> differing_results;  ///< Names of results that differ from those that the daemon recorded.
  std::optional<PlateSize> plate;
  bool is_force_plate = false;                ///< The rig is a force plate, not a bending plate.
  bool corrects_two_feet = false;             ///< The rig's calibration has a correction for two feet.
  std::optional<session::StandingLoad> load;  ///< Only of such a rig.
  std::optional<double> foot_length_mm;
};

/// Reads and analyses. Fails as `make_report`.
[[nodiscard]] core::Result<SessionData> read_session(const ReportSource& source, const ReportProgress& progress);

}  // namespace dts::report
