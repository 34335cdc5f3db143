// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_reaches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <variant>

#include "events/read.h"
#include "record/catalogue/trial_collector.h"
#include "session/session_events.h"

namespace dts::session {
namespace {

using Step = std::variant<core::ReachEvent, core::ClassEvent, TrialEvent>;

/// The result that the daemon recorded when it decided a trial.
struct LiveResult {
  std::uint32_t number = 0;  ///< Of the reach; 0: none.
  std::optional<std::int64_t> trunk_class{};
  std::optional<double> trunk_deg{};

  friend bool operator==(const LiveResult&, const LiveResult&) = default;
};
using TrialKey = std::pair<std::uint32_t, std::uint32_t>;  ///< Trial and attempt.
using LiveResults = std::map<TrialKey, LiveResult>;

struct PlacedStep {
  std::uint32_t segment = 0;
  core::ScanIndex scan;
  Step step;
};

template <class Event>
core::Status add(core::Result<Event> event, const v1::Event& at, std::vector<PlacedStep>& steps) {
  if (!event) return tl::make_unexpected(event.error());
  steps.push_back({.segment = at.segment(), .scan = {at.scan()}, .step = std::move(*event)});
  return {};
}

core::Status add(const v1::Event& event, std::vector<PlacedStep>& steps) {
  if (event.has_reach()) return add(events::reach_of(event), event, steps);
  if (event.has_movement()) return add(events::class_of(event), event, steps);
  if (event.has_trial()) return add(trial_of(event), event, steps);
  return {};
}

/// The results that the daemon recorded when it decided each trial, and again at the end of the session, when it knew the subject's own
/// scale; and those of the session.
struct LiveTrials {
  LiveResults decided;
  LiveResults at_end;
  std::vector<SessionFigure> summary;
};

constexpr std::size_t kMostLiveFigures = 10'000;

void add_live(const v1::Event& event, LiveTrials& live) {
  if (event.has_figure() && live.summary.size() < kMostLiveFigures && std::isfinite(event.figure().value())) {
    const v1::SessionResult& figure = event.figure();
    live.summary.push_back({.name = figure.name(), .value = figure.value(), .unit = figure.unit(), .details = figure.details()});
  }
  if (!event.has_trial_result()) return;
  const v1::TrialResult& result = event.trial_result();
  LiveResults& results = result.is_at_end() ? live.at_end : live.decided;
  if (results.size() >= ReachResults::kMostAttempts) return;
  LiveResult& out = results[{result.trial(), result.attempt()}] = {.number = result.reach().number()};
  if (!result.has_movement()) return;
  out.trunk_class = result.movement().trunk_class();
  if (std::isfinite(result.movement().trunk_deg()) && result.movement().has_trunk_deg()) out.trunk_deg = result.movement().trunk_deg();
}

LiveResult live_of(const ReachTrialResult& result) {
  LiveResult live{.number = result.reach ? result.reach->number : 0};
  if (!result.movement) return live;
  live.trunk_class = static_cast<std::int64_t>(result.movement->trunk_class);
  if (std::isfinite(result.movement->trunk_deg)) live.trunk_deg = result.movement->trunk_deg;
  return live;
}

/// The attempts of a recording by their number.
class Attempts {
 public:
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) {
    using enum TrialEventKind;
    const TrialKey key{event.trial, event.attempt};
    if (event.kind == Go && event.trial > 0 && attempts_.size() < ReachResults::kMostAttempts) {
      attempts_.try_emplace(key, RecordedReachTrial{.trial = event.trial,
                                                    .attempt = event.attempt,
                                                    .block = event.block,
                                                    .condition = event.condition,
                                                    .target_cm = event.target_cm,
                                                    .segment = segment,
                                                    .go = scan,
                                                    .end_segment = segment,
                                                    .end = scan});
    }
    const auto found = attempts_.find(key);
    if (found == attempts_.end()) return;
    RecordedReachTrial& attempt = found->second;
    if (event.kind == Done || event.kind == Redone || event.kind == Rejected || event.kind == Aborted) {
      if (event.kind == Done || !done_.contains(key)) {  // a trial that is voided after its end keeps its end
        attempt.end_segment = segment;
        attempt.end = scan;
      }
      if (event.kind == Done) done_.insert(key);
    }
  }
  void compare(const std::vector<ReachTrialResult>& results, const LiveResults& live, RecordedReaches& recorded) {
    for (const ReachTrialResult& result : results) {
      const auto attempt = attempts_.find({result.trial, result.attempt});
      if (attempt != attempts_.end() && !attempt->second.first_movement) attempt->second.first_movement = result.movement;
      const auto found = live.find({result.trial, result.attempt});
      if (found == live.end()) continue;
      const bool differs = found->second != live_of(result);
      ++recorded.live_results;
      if (differs) ++recorded.differing;
      if (attempt == attempts_.end()) continue;
      attempt->second.is_compared = true;
      attempt->second.differs = attempt->second.differs || differs;
    }
  }
  /// Returns those that took place, in the order of their cues, each with its outcome and its result.
  [[nodiscard]] std::vector<RecordedReachTrial> all(const std::vector<record::TrialRow>& rows,
                                                    const std::vector<ReachTrialResult>& results) && {
    for (const record::TrialRow& row : rows) {
      if (const auto found = attempts_.find({row.trial, row.attempt}); found != attempts_.end()) found->second.outcome = row.outcome;
    }
    for (const ReachTrialResult& result : results) {
      if (const auto found = attempts_.find({result.trial, result.attempt}); found != attempts_.end()) found->second.result = result;
    }
    std::vector<RecordedReachTrial> attempts;
    for (auto& [key, attempt] : attempts_) {
      if (!attempt.outcome.empty()) attempts.push_back(std::move(attempt));
    }
    std::ranges::stable_sort(attempts, {}, [](const RecordedReachTrial& one) { return std::pair(one.segment, one.go); });
    return attempts;
  }

 private:
  std::map<TrialKey, RecordedReachTrial> attempts_;
  std::set<TrialKey> done_;  ///< Also if they were redone or rejected later.
};

core::Result<std::vector<PlacedStep>> read_steps(record::Recording& recording, LiveTrials& live, record::TrialCollector& trials,
                                                 const std::function<void(double)>& progress) {
  std::vector<PlacedStep> steps;
  while (true) {
    DTS_TRY_ASSIGN(auto item, recording.next());
    if (!item) break;
    if (recording.size() > 0) progress(static_cast<double>(recording.offset()) / static_cast<double>(recording.size()));
    trials.add(*item);
    const auto* timed = std::get_if<record::TimedEvent>(&*item);
    if (timed == nullptr) continue;
    add_live(timed->event, live);
    DTS_TRY(add(timed->event, steps));
    if (steps.size() > kMostRecordedSteps) {
      return core::fail(core::ErrorCode::Unsupported,
                        "the recording has more than " + std::to_string(kMostRecordedSteps) + " steps of reaches and trials",
                        "give a recording of one session of the reaching task");
    }
  }
  // Two threads send events to the recorder; the scans define the order.
  std::ranges::stable_sort(steps, {}, [](const PlacedStep& step) { return std::pair(step.segment, step.scan); });
  return steps;
}

void add(const PlacedStep& placed, ReachResults& results, Attempts& attempts) {
  if (const auto* reach = std::get_if<core::ReachEvent>(&placed.step)) results.take(*reach);
  if (const auto* movement = std::get_if<core::ClassEvent>(&placed.step)) results.take(*movement);
  const auto* trial = std::get_if<TrialEvent>(&placed.step);
  if (trial == nullptr) return;
  results.take(*trial, placed.segment, placed.scan);
  attempts.take(*trial, placed.segment, placed.scan);
}

std::uint64_t count_reaches(const std::vector<PlacedStep>& steps) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> numbers;  // a second final event with the same number is the same reach
  for (const PlacedStep& placed : steps) {
    const auto* reach = std::get_if<core::ReachEvent>(&placed.step);
    if (reach == nullptr) continue;
    if (reach->step == core::ReachStep::Final) numbers.insert({reach->segment, reach->number});
    if (reach->step == core::ReachStep::Cancelled) numbers.erase({reach->segment, reach->number});
  }
  return numbers.size();
}

}  // namespace

core::Result<RecordedReaches> read_recorded_reaches(record::Recording& recording, const classifier::TrunkModel* model,
                                                    const std::function<void(double)>& progress) {
  LiveTrials live;
  record::TrialCollector trials(recording.find_stream("raw"));
  DTS_TRY_ASSIGN(const auto steps, read_steps(recording, live, trials, progress));
  RecordedReaches recorded;
  if (const auto& facts = recording.session()) recorded.person = person_of(facts->fields);
  ReachResults results(recorded.person, model);
  Attempts attempts;
  for (const PlacedStep& step : steps) {
    results.advance(step.segment, step.scan);
    attempts.compare(results.take_decided(), live.decided, recorded);  // uses only what was known at that time
    add(step, results, attempts);
  }
  results.finish();
  attempts.compare(results.take_decided(), live.decided, recorded);
  recorded.reaches = count_reaches(steps);
  recorded.trials = results.results();
  attempts.compare(recorded.trials, live.at_end, recorded);
  recorded.attempts = std::move(attempts).all(trials.rows(), results.results_of_void_too());
  recorded.summary = results.summary();
  recorded.live_summary = std::move(live.summary);
  recorded.scale = results.own_scale();
  return recorded;
}

}  // namespace dts::session
