// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/trial_collector.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <variant>

#include "core/utf8.h"
#include "dts/wire/event_json.h"
#include "dts/wire/options.h"

namespace dts::record {
namespace {

constexpr std::size_t kMostTrials = 100'000;
constexpr std::uint32_t kLargestTrialNumber = 1'000'000;
constexpr std::size_t kMostResults = 10'000;
constexpr std::size_t kMostMarkers = 10'000;
constexpr std::size_t kLongestMarker = 200;  // of dtsd; another program may write more
constexpr std::size_t kLongestCondition = 64;

bool is_number(std::uint32_t number) { return number >= 1 && number <= kLargestTrialNumber; }

bool is_start(v1::TrialEventKind step) {
  return step == v1::TRIAL_EVENT_KIND_READY || step == v1::TRIAL_EVENT_KIND_GO || step == v1::TRIAL_EVENT_KIND_MEASURE;
}
bool is_end(v1::TrialEventKind step) {
  return step == v1::TRIAL_EVENT_KIND_DONE || step == v1::TRIAL_EVENT_KIND_REDONE || step == v1::TRIAL_EVENT_KIND_REJECTED ||
         step == v1::TRIAL_EVENT_KIND_ABORTED;
}
bool is_step_of_trial(v1::TrialEventKind step) { return is_start(step) || is_end(step) || step == v1::TRIAL_EVENT_KIND_UNDONE; }

/// Sets the start of the trial. Called for ready, go and measure, so that the last of them is the start.
void begin(const v1::Event& event, TrialRow& row) {
  row.block = is_number(event.trial().block()) ? event.trial().block() : 1;
  row.condition = event.trial().condition().substr(0, kLongestCondition);
  row.segment = event.segment();
  row.first_scan = event.scan();
}

/// Sets the outcome. A trial that was done and later rejected or redone keeps its end. A Done that was due before an undo may precede the
/// undo in the file.
void end(const v1::Event& event, bool was_done, TrialRow& row) {
  if (!was_done) {
    row.last_segment = event.segment();
    row.last_scan = event.scan();
  }
  if (event.trial().step() == v1::TRIAL_EVENT_KIND_DONE && !row.outcome.empty()) return;
  row.outcome = wire::enumerator_word(*v1::TrialEventKind_descriptor(), event.trial().step());
}

}  // namespace

void TrialCollector::add(const RecordedItem& item) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) {
    if (raw_ && scans->stream == *raw_ && scans->count > 0) {
      newest_ = std::max(newest_, Place{scans->segment, scans->first_scan.value + (scans->count - 1)});
    }
  } else if (const auto* timed = std::get_if<TimedEvent>(&item)) {
    newest_ = std::max(newest_, Place{timed->event.segment(), timed->event.scan()});
    add(timed->event);
  }
}

void TrialCollector::add(const v1::Event& event) {
  if (event.has_marker() && markers_.size() < kMostMarkers) {
    markers_.push_back({.session_id = {},
                        .number = static_cast<std::uint32_t>(markers_.size() + 1),
                        .segment = event.segment(),
                        .scan = event.scan(),
                        .text = core::printable(event.marker().text().substr(0, kLongestMarker))});
  }
  if (event.has_trial()) add_step(event);
  if (event.has_trial_result()) add_result(event, event.trial_result().trial(), event.trial_result().attempt());
  if (event.has_sway() && !event.sway().is_preliminary()) add_result(event, event.sway().trial(), event.sway().attempt());
  if (event.has_figure()) add_session_result(event.figure());
}

void TrialCollector::add_step(const v1::Event& event) {
  const v1::TrialChange& change = event.trial();
  if (!is_number(change.trial()) || !is_number(change.attempt()) || !is_step_of_trial(change.step())) return;
  if (rows_.size() >= kMostTrials && !rows_.contains({change.trial(), change.attempt()})) return;
  TrialRow& row = rows_[{change.trial(), change.attempt()}];
  if (row.trial == 0) {  // the first event of this trial, of any step
    row.trial = change.trial();
    row.attempt = change.attempt();
    begin(event, row);
    std::uint32_t& newest = begun_attempts_[change.trial()];
    newest = std::max(newest, change.attempt());
  }
  const bool was_done = done_.contains({change.trial(), change.attempt()});
  if (change.step() == v1::TRIAL_EVENT_KIND_DONE) done_.insert({change.trial(), change.attempt()});
  if (is_end(change.step())) {
    end(event, was_done, row);
  } else if (change.step() == v1::TRIAL_EVENT_KIND_UNDONE) {
    undo(row);
  } else if (!was_done) {
    begin(event, row);
  }
}

/// The attempt continues, or is done. The attempt that a redo began did not take place.
void TrialCollector::undo(TrialRow& row) {
  const auto of_row = rows_.find({row.trial, row.attempt});
  row.outcome = done_.contains(of_row->first) ? wire::enumerator_word(*v1::TrialEventKind_descriptor(), v1::TRIAL_EVENT_KIND_DONE) : "";
  rows_.erase(std::next(of_row), rows_.upper_bound({row.trial, std::numeric_limits<std::uint32_t>::max()}));
}

void TrialCollector::add_result(const v1::Event& event, std::uint32_t trial, std::uint32_t attempt) {
  if (const auto row = rows_.find({trial, attempt}); row != rows_.end()) row->second.result = wire::to_json(event);
}

void TrialCollector::add_session_result(const v1::SessionResult& result) {
  if (!std::isfinite(result.value()) || result.name().empty() || session_results_.size() >= kMostResults) return;
  session_results_[result.name()] = {
      .session_id = {}, .name = result.name(), .value = result.value(), .unit = result.unit(), .details = result.details()};
}

std::vector<ResultRow> TrialCollector::session_results() const {
  std::vector<ResultRow> rows;
  for (const auto& [name, row] : session_results_) rows.push_back(row);
  return rows;
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
