// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/trial_collector.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <variant>

namespace dts::record {
namespace {

constexpr std::size_t kMostTrials = 100'000;
constexpr std::int64_t kLargestTrialNumber = 1'000'000;
constexpr std::size_t kMostFigures = 10'000;
constexpr std::size_t kLongestCondition = 64;

std::optional<std::uint32_t> event_number(const RecordedEvent& event, std::string_view key) {
  const auto found = std::ranges::find_if(event.values, [key](const auto& value) { return value.first == key; });
  if (found == event.values.end()) return std::nullopt;
  const auto* number = std::get_if<std::int64_t>(&found->second);
  if (number == nullptr || *number < 1 || *number > kLargestTrialNumber) return std::nullopt;
  return static_cast<std::uint32_t>(*number);
}

bool is_end(std::string_view phase) { return phase == "done" || phase == "redone" || phase == "rejected" || phase == "aborted"; }

}  // namespace

void TrialCollector::take(const RecordedItem& item) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) {
    if (raw_ && scans->stream == *raw_ && scans->count > 0) {
      newest_ = std::max(newest_, Place{scans->segment, scans->first_scan.value + (scans->count - 1)});
    }
  } else if (const auto* timed = std::get_if<TimedEvent>(&item)) {
    newest_ = std::max(newest_, Place{timed->event.segment, timed->event.scan.value});
    if (timed->event.event == "trial") take_event(timed->event);
    if (timed->event.event == "result" || timed->event.event == "sway") take_result(timed->event);
    if (timed->event.event == "figure") take_figure(timed->event);
  }
}

void TrialCollector::take_event(const RecordedEvent& event) {
  const std::string phase = text_of(event, "phase");
  const auto trial = event_number(event, "trial");
  const auto attempt = event_number(event, "attempt");
  const bool is_start = phase == "ready" || phase == "go" || phase == "measure";
  if (!trial || !attempt || !(is_start || is_end(phase))) return;
  if (rows_.size() >= kMostTrials && !rows_.contains({*trial, *attempt})) return;
  TrialRow& row = rows_[{*trial, *attempt}];
  if (row.trial == 0) {  // the first event of this trial, of any phase
    row.trial = *trial;
    row.attempt = *attempt;
    begin(event, row);
  }
  if (is_start) {
    if (row.outcome.empty()) begin(event, row);
  } else {
    end(phase, event, row);
  }
}

void TrialCollector::take_result(const RecordedEvent& event) {
  const auto row = rows_.find({event_number(event, "trial").value_or(0), event_number(event, "attempt").value_or(0)});
  if (row != rows_.end()) row->second.result = to_json(event);
}

void TrialCollector::take_figure(const RecordedEvent& event) {
  const auto value = std::ranges::find_if(event.values, [](const auto& held) { return held.first == "value"; });
  const auto* number = value != event.values.end() ? std::get_if<double>(&value->second) : nullptr;
  const std::string name = text_of(event, "name");
  if (number == nullptr || !std::isfinite(*number) || name.empty() || figures_.size() >= kMostFigures) return;
  figures_[name] = {.session_id = {}, .name = name, .value = *number, .unit = text_of(event, "unit"), .details = text_of(event, "details")};
}

std::vector<ResultRow> TrialCollector::figures() const {
  std::vector<ResultRow> rows;
  for (const auto& [name, row] : figures_) rows.push_back(row);
  return rows;
}

/// Sets the start of the trial. Called for ready, go and measure, so that the last of them is the start.
void TrialCollector::begin(const RecordedEvent& event, TrialRow& row) const {
  row.block = event_number(event, "block").value_or(1);
  row.condition = text_of(event, "condition").substr(0, kLongestCondition);
  row.segment = event.segment;
  row.first_scan = event.scan.value;
}

/// Sets the outcome. A trial that was done and later rejected or redone keeps its end.
void TrialCollector::end(const std::string& phase, const RecordedEvent& event, TrialRow& row) const {
  if (row.outcome.empty()) {
    row.last_segment = event.segment;
    row.last_scan = event.scan.value;
  }
  row.outcome = phase;
}

std::vector<TrialRow> TrialCollector::rows() const {
  std::vector<TrialRow> rows;
  for (const auto& [key, row] : rows_) {
    rows.push_back(row);
    if (!row.outcome.empty()) continue;
    rows.back().outcome = "aborted";
    rows.back().last_segment = newest_.first;
    rows.back().last_scan = newest_.second;
  }
  return rows;
}

}  // namespace dts::record
