// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "record/catalogue/trial_collector.h"
#include "record/recording.h"

namespace dts::record {

/// Returns everything about a recording that its tables do not contain, as JSON: session, fields of the subject, device, stages, streams
/// and missing scans (lost_scans, gaps, losses by reason), and corrections with both values. `has_texts`: includes free texts: label,
/// notes, reasons and authors of corrections.
[[nodiscard]] std::string recording_document(const Recording& recording, const Corrections& corrections, bool has_texts);

/// Collects the trials of a recording during an export. Scans and events arrive on different threads.
class TrialTable {
 public:
  explicit TrialTable(const Recording& recording)
      : raw_(recording.find_stream("raw")), trials_(raw_), part_(recording.session() ? leading_part(*recording.session()) : 1) {}

  /// Thread: the stream's thread.
  void add(const RecordedScans& scans) noexcept;
  /// Thread: the events' thread.
  void add(const TimedEvent& event) { trials_.add(RecordedItem(event)); }
  /// Returns the trials as CSV, each with the measures of its result, with the corrected outcomes and, if there are any, the recorded ones
  /// beside them; empty if there was none. Call it after the last `add`.
  [[nodiscard]] std::string text(const Corrections& corrections);

 private:
  std::optional<std::size_t> raw_;
  RecordedScans newest_{};
  TrialCollector trials_;
  std::uint32_t part_;  ///< That corrections name.
};

}  // namespace dts::record
