// SPDX-License-Identifier: Apache-2.0
#include "session/sway_results.h"

#include <algorithm>

namespace dts::session {
namespace {

/// The control thread computes this: 1 min at 100 Hz needs 5 ms, 10 min at 1500 Hz 0.5 s.
constexpr double kLongestTrialS = 600.0;
constexpr double kLastWordMs = 200.0;  // waits for the last event of the stage `steadiness`, 80 ms and one block after the end

TracePlace begin_of(const SwayTrialResult& result) { return {.segment = result.segment, .scan = result.first_scan}; }
TracePlace end_of(const SwayTrialResult& result) { return {.segment = result.end_segment, .scan = result.end_scan}; }

/// Returns why a trial cannot be cut from the trace.
std::string why_not(const SwayTrialResult& result, const CopTrace& trace) {
  if (result.end_segment == result.segment && result.end_scan <= result.first_scan) return "no samples arrived during the measurement";
  if (!trace.reaches(end_of(result))) return "the session ended before the last samples of the trial arrived";
  return "samples were dropped before the analysis: analyse the recording with dtslab sway";
}

void analyse(SwayTrialResult& result, const CopTrace& trace, core::Rate raw_rate) {
  const auto is_too_long = [](double duration_s) { return duration_s > kLongestTrialS; };
  const auto series = trace.cut(begin_of(result), end_of(result));
  const bool is_divided = result.end_segment != result.segment;
  const double scans = static_cast<double>(result.end_scan.value) - static_cast<double>(result.first_scan.value);
  if (is_too_long(series ? static_cast<double>(series->ml_mm.size()) / series->rate_hz : 0.0) ||
      (!is_divided && is_too_long(scans / raw_rate.hz()))) {
    result.problem = "longer than 10 min: analyse the recording with dtslab sway";
    return;
  }
  if (!series) {
    result.problem = why_not(result, trace);
    return;
  }
  auto analysis = posturography::analyse(*series, {.preparation = posturography::kReportPreparation});
  if (analysis) {
    result.analysis = std::move(*analysis);
  } else {
    result.problem = analysis.error().what;
  }
}

}  // namespace

SwayResults::SwayResults(core::Rate raw_rate, core::Rate cop_rate)
    : raw_rate_(raw_rate), trace_(raw_rate, cop_rate), last_word_scans_(raw_rate.scans_in_ms(kLastWordMs)) {}

void SwayResults::take(const core::Block& cop) {
  trace_.take(cop);
  decide();
}

void SwayResults::take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) {
  using enum TrialEventKind;
  const bool counts =
      event.kind == Measure || event.kind == Done || event.kind == Redone || event.kind == Rejected || event.kind == Aborted;
  if (!counts || event.trial == 0) return;
  const Key key{event.trial, event.attempt};
  if (!attempts_.contains(key) && attempts_.size() >= kMostAttempts) return;
  Attempt& attempt = attempts_[key];
  if (event.kind == Measure) {
    begin(attempt, event, segment, scan);
    open_.push_back(key);
  } else if (event.kind == Done && attempt.state == State::Measuring) {
    attempt.result.end_scan = scan;
    attempt.result.end_segment = segment;
    attempt.state = State::Waiting;
  } else if (event.kind != Done) {
    attempt.state = State::Void;
  }
  decide();
}

void SwayResults::begin(Attempt& attempt, const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) {
  attempt.state = State::Measuring;
  attempt.result = {.trial = event.trial,
                    .attempt = event.attempt,
                    .condition = event.condition,
                    .labels = event.labels,
                    .segment = segment,
                    .first_scan = scan,
                    .end_scan = scan,
                    .end_segment = segment};
}

void SwayResults::finish() {
  for (const Key& key : open_) {
    if (Attempt& attempt = attempts_[key]; attempt.state == State::Waiting) finish_trial(attempt);
  }
  decide();
}

/// Finishes trials whose samples have all arrived, and keeps the samples of the other trials under way.
void SwayResults::decide() {
  std::optional<TracePlace> kept_from;
  const auto order = [](const TracePlace& place) { return std::pair(place.segment, place.scan); };
  std::erase_if(open_, [&](const Key& key) {
    Attempt& attempt = attempts_[key];
    const SwayTrialResult& result = attempt.result;
    if (attempt.state == State::Waiting && trace_.reaches({.segment = result.end_segment, .scan = result.end_scan + last_word_scans_})) {
      finish_trial(attempt);
    }
    const bool is_open = attempt.state == State::Measuring || attempt.state == State::Waiting;
    if (is_open && (!kept_from || order(begin_of(result)) < order(*kept_from))) kept_from = begin_of(result);
    return !is_open;
  });
  trace_.keep_from(kept_from);
}

void SwayResults::finish_trial(Attempt& attempt) {
  attempt.state = State::Decided;
  analyse(attempt.result, trace_, raw_rate_);
  decided_.push_back(attempt.result);
}

std::vector<SwayTrialResult> SwayResults::take_decided() {
  std::vector<SwayTrialResult> decided = std::exchange(decided_, {});
  std::erase_if(decided, [this](const SwayTrialResult& result) {
    return attempts_.at({result.trial, result.attempt}).state == State::Void;
  });
  return decided;
}

std::vector<SessionFigure> SwayResults::summary() const {
  std::vector<SwayTrialResult> counting;
  for (const auto& [key, attempt] : attempts_) {
    if (attempt.state == State::Decided) counting.push_back(attempt.result);
  }
  return sway_summary(counting);
}

}  // namespace dts::session
