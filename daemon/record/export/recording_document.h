// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "record/catalogue/trial_collector.h"
#include "record/recording.h"

namespace dts::record {

/// Returns everything about a recording that its tables do not contain, as JSON: session, fields of the subject, device, stages, streams
/// and missing scans (lost_scans, gaps, losses by reason). `has_label`: includes the session's label, which is free text.
[[nodiscard]] std::string recording_document(const Recording& recording, bool has_label);

/// Collects the trials of a recording during an export. Scans and events arrive on different threads.
class TrialTable {
 public:
  explicit TrialTable(const Recording& recording) : raw_(recording.find_stream("raw")), trials_(raw_) {}

  /// Thread: the stream's thread.
  void add(const RecordedScans& scans) noexcept;
  /// Thread: the events' thread.
  void add(const TimedEvent& event) { trials_.add(RecordedItem(event)); }
  /// Returns the trials as CSV, each with the measures of its result; empty if there was none. Call it after the last `add`.
  [[nodiscard]] std::string text();

 private:
  std::optional<std::size_t> raw_;
  RecordedScans newest_{};
  TrialCollector trials_;
};

}  // namespace dts::record
