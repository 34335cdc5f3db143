// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/trial_collector.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "dts/wire/event_json.h"
#include "dts/wire/options.h"

namespace dts::record {
namespace {

constexpr std::size_t kMostTrials = 100'000;
constexpr std::uint32_t kLargestTrialNumber = 1'000'000;
constexpr std::size_t kMostFigures = 10'000;
constexpr std::size_t kLongestCondition = 64;

bool is_number(std::uint32_t number) { return number >= 1 && number <= kLargestTrialNumber; }

bool is_start(v1::TrialEventKind step) {
  return step == v1::TRIAL_EVENT_KIND_READY || step == v1::TRIAL_EVENT_KIND_GO || step == v1::TRIAL_EVENT_KIND_MEASURE;
}
bool is_end(v1::TrialEventKind step) {
  return step == v1::TRIAL_EVENT_KIND_DONE || step == v1::TRIAL_EVENT_KIND_REDONE || step == v1::TRIAL_EVENT_KIND_REJECTED ||
         step == v1::TRIAL_EVENT_KIND_ABORTED;
}

/// Sets the start of the trial. Called for ready, go and measure, so that the last of them is the start.
void begin(const v1::Event& event, TrialRow& row) {
  row.block = is_number(event.trial().block()) ? event.trial().block() : 1;
  row.condition = event.trial().condition().substr(0, kLongestCondition);
  row.segment = event.segment();
  row.first_scan = event.scan();
}

/// Sets the outcome. A trial that was done and later rejected or redone keeps its end.
void end(const v1::Event& event, TrialRow& row) {
  if (row.outcome.empty()) {
    row.last_segment = event.segment();
    row.last_scan = event.scan();
  }
  row.outcome = wire::enumerator_word(*v1::TrialEventKind_descriptor(), event.trial().step());
}

}  // namespace

void TrialCollector::take(const RecordedItem& item) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) {
    if (raw_ && scans->stream == *raw_ && scans->count > 0) {
      newest_ = std::max(newest_, Place{scans->segment, scans->first_scan.value + (scans->count - 1)});
    }
  } else if (const auto* timed = std::get_if<TimedEvent>(&item)) {
    newest_ = std::max(newest_, Place{timed->event.segment(), timed->event.scan()});
    take(timed->event);
  }
}

void TrialCollector::take(const v1::Event& event) {
  if (event.has_trial()) take_step(event);
  if (event.has_trial_result()) take_result(event, event.trial_result().trial(), event.trial_result().attempt());
  if (event.has_sway() && !event.sway().is_preliminary()) take_result(event, event.sway().trial(), event.sway().attempt());
  if (event.has_figure()) take_figure(event.figure());
}

void TrialCollector::take_step(const v1::Event& event) {
  const v1::TrialChange& told = event.trial();
  if (!is_number(told.trial()) || !is_number(told.attempt()) || !(is_start(told.step()) || is_end(told.step()))) return;
  if (rows_.size() >= kMostTrials && !rows_.contains({told.trial(), told.attempt()})) return;
  TrialRow& row = rows_[{told.trial(), told.attempt()}];
  if (row.trial == 0) {  // the first event of this trial, of any step
    row.trial = told.trial();
    row.attempt = told.attempt();
    begin(event, row);
  }
  if (is_end(told.step())) {
    end(event, row);
  } else if (row.outcome.empty()) {
    begin(event, row);
  }
}

void TrialCollector::take_result(const v1::Event& event, std::uint32_t trial, std::uint32_t attempt) {
  if (const auto row = rows_.find({trial, attempt}); row != rows_.end()) row->second.result = wire::to_json(event);
}

void TrialCollector::take_figure(const v1::SessionResult& figure) {
  if (!std::isfinite(figure.value()) || figure.name().empty() || figures_.size() >= kMostFigures) return;
  figures_[figure.name()] = {
      .session_id = {}, .name = figure.name(), .value = figure.value(), .unit = figure.unit(), .details = figure.details()};
}

std::vector<ResultRow> TrialCollector::figures() const {
  std::vector<ResultRow> rows;
  for (const auto& [name, row] : figures_) rows.push_back(row);
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
