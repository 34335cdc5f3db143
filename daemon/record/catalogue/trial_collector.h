// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "record/catalogue/catalogue.h"
#include "record/recording.h"

namespace dts::record {

/// Makes trial and marker rows from the events of a recording. The rows equal those that the daemon stored during the recording. Uses the
/// steps of trials, their results and the results of the session. Skips invalid events. If the recording ends during a trial, the trial
/// counts as aborted there.
class TrialCollector {
 public:
  /// `raw`: index of the stream whose scans the events count; absent: the end of the recording is the place of its last event.
  explicit TrialCollector(std::optional<std::size_t> raw) : raw_(raw) {}

  void add(const RecordedItem& item);
  /// Returns the rows, sorted by trial and attempt. The caller sets `session_id` and `part`.
  [[nodiscard]] std::vector<TrialRow> rows() const;
  /// Returns the newest attempt of each trial that has begun, also one that an undo took back.
  [[nodiscard]] const std::map<std::uint32_t, std::uint32_t>& begun_attempts() const { return begun_attempts_; }
  /// Returns the markers in the order of the recording. The caller sets `session_id` and `part`.
  [[nodiscard]] std::vector<MarkerRow> markers() const { return markers_; }
  /// Returns the results of the whole session. The caller sets `session_id`.
  [[nodiscard]] std::vector<ResultRow> session_results() const;

 private:
  using Place = std::pair<std::uint32_t, std::uint64_t>;  ///< Segment, scan.
  void add(const v1::Event& event);
  void add_step(const v1::Event& event);
  void undo(TrialRow& row);
  void add_result(const v1::Event& event, std::uint32_t trial, std::uint32_t attempt);
  void add_session_result(const v1::SessionResult& result);

  std::optional<std::size_t> raw_;
  Place newest_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, TrialRow> rows_;  ///< By trial and attempt. Empty outcome: the trial has not ended.
  std::set<std::pair<std::uint32_t, std::uint32_t>> done_;            ///< Trial and attempt, also if they were redone or rejected later.
  std::map<std::uint32_t, std::uint32_t> begun_attempts_;             ///< Newest attempt by trial.
  std::map<std::string, ResultRow> session_results_;
  std::vector<MarkerRow> markers_;
};

}  // namespace dts::record
