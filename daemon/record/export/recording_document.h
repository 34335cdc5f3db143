// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "record/catalogue/trial_collector.h"
#include "record/recording.h"

namespace dts::record {

/// Everything about a recording that its tables do not show, as JSON: session, subject's fields, device, stages, streams, and what is
/// missing (lost_scans, gaps, losses by reason). `has_label`: the session's label, free text, may be among it.
[[nodiscard]] std::string recording_document(const Recording& recording, bool has_label);

/// The trials of a recording, collected on the way of an export: scans and events come from different threads.
class TrialTable {
 public:
  explicit TrialTable(const Recording& recording) : raw_(recording.find_stream("raw")), trials_(raw_) {}

  /// Thread: that of the stream.
  void take(const RecordedScans& scans) noexcept;
  /// Thread: that of the events.
  void take(const TimedEvent& event) { trials_.take(RecordedItem(event)); }
  /// As CSV, when all has been taken; empty: there was no trial.
  [[nodiscard]] std::string text();

 private:
  std::optional<std::size_t> raw_;
  RecordedScans newest_{};
  TrialCollector trials_;
};

}  // namespace dts::record
