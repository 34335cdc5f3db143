// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/catalogue.h"

namespace dts::fhir {

/// A time of the rig's computer in UTC; absent: the recording does not say when it was.
struct Period {
  std::optional<std::int64_t> begins_utc_ns{};
  std::optional<std::int64_t> ends_utc_ns{};
};

/// An attempt of a trial that was done, or that was taken for done before a correction.
struct RecordedTrial {
  record::TrialRow row{};  ///< With the corrected outcome.
  Period period{};         ///< Of the measurement.
  bool is_corrected = false;

  [[nodiscard]] bool is_withdrawn() const { return row.outcome != "done"; }
};

/// A recording of the rig that leads the session.
struct RecordedPart {
  record::SessionFacts facts{};  ///< With the corrected subject ID.
  std::string file{};            ///< Without its folder.
  std::string damage{};          ///< Empty: the file is whole.
  Period period{};
  std::vector<RecordedTrial> trials{};
  std::vector<record::ResultRow> results{};  ///< Of the session, from the trials that are done after corrections; none with other parts.
  bool is_interrupted = false;               ///< The part has valid trials and no results: it ended before the session's end.
  bool has_corrected_outcomes = false;
  bool has_corrected_subject = false;
};

struct RecordedSession {
  std::vector<RecordedPart> parts{};  ///< At least one.
  record::Corrections corrections{};
};

/// Receives the progress, 0..1. Returns false to stop the work.
using BundleProgress = std::function<bool(double)>;

/// Reads the parts of one session, in order; leaves out parts of companions, unless there are no others. Fails with Unsupported for a
/// recording of another program or for parts of two sessions, with DataDamaged if a closed file does not match its checksums or a result
/// cannot be read, with Failed if `progress` stops it. Reads a torn file up to the damage. Thread: any.
[[nodiscard]] core::Result<RecordedSession> read_recorded_session(const std::vector<std::string>& files, const BundleProgress& progress);

}  // namespace dts::fhir
