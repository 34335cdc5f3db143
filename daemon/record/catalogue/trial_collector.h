// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "record/catalogue/catalogue.h"
#include "record/event.h"
#include "record/recording.h"

namespace dts::record {

/// Makes trial rows from the events of a recording. The rows equal those that the daemon stored during the recording. Uses the events
/// "trial" with phase (ready, go, measure, done, redone, rejected, aborted), trial, attempt, block and condition. Skips invalid events. If
/// the recording ends during a trial, the trial counts as aborted there.
class TrialCollector {
 public:
  /// `raw`: index of the stream whose scans the events count; absent: the end of the recording is the place of its last event.
  explicit TrialCollector(std::optional<std::size_t> raw) : raw_(raw) {}

  void take(const RecordedItem& item);
  /// Returns the rows, sorted by trial and attempt. The caller sets `session_id` and `part`.
  [[nodiscard]] std::vector<TrialRow> rows() const;
  /// Returns the results of the whole session. The caller sets `session_id`.
  [[nodiscard]] std::vector<ResultRow> figures() const;

 private:
  using Place = std::pair<std::uint32_t, std::uint64_t>;  ///< Segment, scan.
  void take_event(const RecordedEvent& event);
  void take_result(const RecordedEvent& event);
  void take_figure(const RecordedEvent& event);
  void begin(const RecordedEvent& event, TrialRow& row) const;
  void end(const std::string& phase, const RecordedEvent& event, TrialRow& row) const;

  std::optional<std::size_t> raw_;
  Place newest_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, TrialRow> rows_;  ///< By trial and attempt. Empty outcome: the trial has not ended.
  std::map<std::string, ResultRow> figures_;
};

}  // namespace dts::record
