// SPDX-License-Identifier: Apache-2.0
#include "session/sway_results.h"

#include <algorithm>
#include <exception>

#include "session/standing_load.h"

namespace dts::session {
namespace {

/// The analysis needs 5 ms for 1 min at 100 Hz, and about 0.5 s for 10 min at 1500 Hz (sway_bench).
constexpr double kLongestTrialS = 600.0;
constexpr double kUndoMs = kUndoS * 1e3 + 2000.0;  // an undo is due before its event arrives
constexpr double kLastWordMs = 200.0;              // waits for the last event of the stage `steadiness`, 80 ms and one block after the end

TracePlace begin_of(const SwayTrialResult& result) { return {.segment = result.segment, .scan = result.first_scan}; }
TracePlace end_of(const SwayTrialResult& result) { return {.segment = result.end_segment, .scan = result.end_scan}; }

/// Returns why a trial cannot be cut from the trace.
std::string why_not(const SwayTrialResult& result, const CopTrace& trace) {
  if (result.end_segment == result.segment && result.end_scan <= result.first_scan) return "no samples arrived during the measurement";
  if (!trace.reaches(end_of(result))) return "the session ended before the last samples of the trial arrived";
  return "samples were dropped before the analysis: analyse the recording with dtslab sway";
}

/// Returns the samples of a trial, or nothing and sets `result.problem`.
std::optional<CopCut> samples_of(SwayTrialResult& result, const CopTrace& trace, core::Rate raw_rate) {
  const auto is_too_long = [](double duration_s) { return duration_s > kLongestTrialS; };
  auto samples = trace.cut(begin_of(result), end_of(result));
  const bool is_divided = result.end_segment != result.segment;
  const double scans = static_cast<double>(result.end_scan.value) - static_cast<double>(result.first_scan.value);
  if (is_too_long(samples ? samples->duration_s() : 0.0) || (!is_divided && is_too_long(scans / raw_rate.hz()))) {
    result.problem = "longer than 10 min: analyse the recording with dtslab sway";
    return std::nullopt;
  }
  if (!samples) result.problem = why_not(result, trace);
  return samples;
}

}  // namespace

SwayResults::SwayResults(core::Rate raw_rate, core::Rate cop_rate, core::Worker& worker)
    : raw_rate_(raw_rate),
      worker_(worker),
      trace_(raw_rate, cop_rate),
      last_word_scans_(raw_rate.scans_in_ms(kLastWordMs)),
      undo_samples_(cop_rate.scans_in_ms(kUndoMs)) {}

core::Result<SwayResults::Analysed> SwayResults::analyse(const CopCut& samples) {
  try {
    const posturography::CopSeries series = samples.series();
    DTS_TRY_ASSIGN(auto analysis, posturography::analyse(series, {.preparation = posturography::kReportPreparation}));
    return Analysed{.analysis = std::move(analysis), .mean_load_n = mean_load_n(series)};
  } catch (const std::exception& error) {  // no memory: not a reason to end the daemon
    return core::fail(core::ErrorCode::LimitExceeded, std::string(error.what()) + ": analyse the recording with dtslab sway");
  }
}

void SwayResults::take(const core::Block& cop) {
  trace_.take(cop);
  end_complete();
}

void SwayResults::take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) {
  using enum TrialEventKind;
  const bool counts = event.kind == Measure || event.kind == Done || event.kind == Redone || event.kind == Rejected ||
                      event.kind == Aborted || event.kind == Undone;
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
  } else if (event.kind == Undone) {
    undo(key);
  } else if (event.kind != Done) {
    attempt.voided = TracePlace{segment, scan};
  }
  end_complete();
}

/// The attempt is valid again, and later attempts of its trial are void.
void SwayResults::undo(const Key& key) {
  for (auto& [other, attempt] : attempts_) {
    if (other.first != key.first || other.second < key.second) continue;
    if (other.second > key.second) {
      if (attempt.state == State::Measuring) attempt.state = State::Dropped;
      continue;
    }
    attempt.voided.reset();
    if (attempt.state != State::Dropped) continue;  // else a gap came meanwhile; `end_trial` reports that samples are missing
    const SwayTrialResult& result = attempt.result;
    const bool has_end = result.end_segment != result.segment || result.end_scan > result.first_scan;
    attempt.state = has_end ? State::Waiting : State::Measuring;
    open_.push_back(key);
  }
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
    if (Attempt& attempt = attempts_[key]; attempt.state == State::Waiting && !attempt.voided) end_trial(key, attempt);
  }
  end_complete();
}

/// Ends trials whose samples have all arrived, and keeps the samples of the other trials under way.
void SwayResults::end_complete() {
  std::optional<TracePlace> kept_from;
  const auto order = [](const TracePlace& place) { return std::pair(place.segment, place.scan); };
  std::erase_if(open_, [&](const Key& key) {
    Attempt& attempt = attempts_[key];
    const SwayTrialResult& result = attempt.result;
    if (attempt.state == State::Waiting && !attempt.voided &&
        trace_.reaches({.segment = result.end_segment, .scan = result.end_scan + last_word_scans_})) {
      end_trial(key, attempt);
    }
    const bool is_lost = attempt.voided && trace_.samples_since(*attempt.voided) >= undo_samples_;
    if (is_lost && (attempt.state == State::Measuring || attempt.state == State::Waiting)) attempt.state = State::Dropped;
    const bool is_open = attempt.state == State::Measuring || attempt.state == State::Waiting;
    if (is_open && (!kept_from || order(begin_of(result)) < order(*kept_from))) kept_from = begin_of(result);
    return !is_open;
  });
  trace_.keep_from(kept_from);
}

void SwayResults::end_trial(const Key& key, Attempt& attempt) {
  attempt.state = State::Ended;
  Ended& ended = ended_.emplace_back(Ended{.key = key, .analysis = {}});
  auto samples = samples_of(attempt.result, trace_, raw_rate_);
  if (samples) ended.analysis = worker_.run([samples = std::move(*samples)] { return analyse(samples); });
}

bool SwayResults::is_analysing() const {
  return std::ranges::any_of(ended_, [](const Ended& ended) { return ended.analysis.valid() && !core::is_ready(ended.analysis); });
}

void SwayResults::wait() const {
  for (const Ended& ended : ended_) {
    if (ended.analysis.valid()) ended.analysis.wait();
  }
}

std::vector<SwayTrialResult> SwayResults::take_decided() {
  std::vector<SwayTrialResult> decided;
  bool is_waiting = false;  // results are returned in order
  std::erase_if(ended_, [&](Ended& ended) {
    Attempt& attempt = attempts_.at(ended.key);
    if (is_waiting) return false;
    is_waiting = ended.analysis.valid() && !core::is_ready(ended.analysis);
    if (is_waiting) return false;
    attempt.state = State::Decided;
    if (ended.analysis.valid()) {
      auto analysis = ended.analysis.get();
      if (analysis) {
        attempt.result.analysis = std::move(analysis->analysis);
        attempt.result.mean_load_n = analysis->mean_load_n;
      } else {
        attempt.result.problem = analysis.error().what;
      }
    }
    decided.push_back(attempt.result);
    return true;
  });
  return decided;
}

std::vector<SwayTrialResult> SwayResults::counting() const {
  std::vector<SwayTrialResult> counting;
  for (const auto& [key, attempt] : attempts_) {
    if (attempt.state == State::Decided && !attempt.voided) counting.push_back(attempt.result);
  }
  return counting;
}

}  // namespace dts::session
