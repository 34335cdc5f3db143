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

/// Makes trial rows of the events of a recording, as the daemon made them when it was recorded: event "trial" with phase (ready, go,
/// measure, done, redone, rejected, aborted), trial, attempt, block and condition. What makes no sense is passed over. A trial that the
/// recording ends in the middle of was aborted there.
class TrialCollector {
 public:
  /// `raw`: index of the stream that events count in; nothing: only events tell how far the recording went.
  explicit TrialCollector(std::optional<std::size_t> raw) : raw_(raw) {}

  void take(const RecordedItem& item);
  /// In the order of trial and attempt. `session_id` and `part` are the caller's.
  [[nodiscard]] std::vector<TrialRow> rows() const;
  /// Figures of the whole session. `session_id` is the caller's.
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
  std::map<std::pair<std::uint32_t, std::uint32_t>, TrialRow> rows_;  ///< By trial and attempt; no outcome: still under way.
  std::map<std::string, ResultRow> figures_;
};

}  // namespace dts::record
