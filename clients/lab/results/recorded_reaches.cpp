// SPDX-License-Identifier: Apache-2.0
#include "lab/results/recorded_reaches.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <variant>

#include "events/read.h"
#include "session/session_events.h"

namespace dts::lab::results {
namespace {

using Step = std::variant<core::ReachEvent, core::ClassEvent, session::TrialEvent>;

/// The result that the daemon recorded when it decided a trial.
struct LiveResult {
  std::uint32_t number = 0;  ///< Of the reach; 0: none.
  std::optional<std::int64_t> trunk_class{};
  std::optional<double> trunk_deg{};

  friend bool operator==(const LiveResult&, const LiveResult&) = default;
};
using LiveResults = std::map<std::pair<std::uint32_t, std::uint32_t>, LiveResult>;  ///< Key: trial and attempt.

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
  if (event.has_trial()) return add(session::trial_of(event), event, steps);
  return {};
}

/// The results that the daemon recorded when it decided each trial, and again at the end of the session, when it knew the subject's own
/// scale.
struct LiveTrials {
  LiveResults decided;
  LiveResults at_end;
};

void add_live(const v1::Event& event, LiveTrials& both) {
  if (!event.has_trial_result()) return;
  const v1::TrialResult& result = event.trial_result();
  LiveResults& live = result.is_at_end() ? both.at_end : both.decided;
  if (live.size() >= session::ReachResults::kMostAttempts) return;
  LiveResult& out = live[{result.trial(), result.attempt()}] = {.number = result.reach().number()};
  if (!result.has_movement()) return;
  out.trunk_class = result.movement().trunk_class();
  if (std::isfinite(result.movement().trunk_deg()) && result.movement().has_trunk_deg()) out.trunk_deg = result.movement().trunk_deg();
}

LiveResult live_of(const session::ReachTrialResult& result) {
  LiveResult live{.number = result.reach ? result.reach->number : 0};
  if (!result.movement) return live;
  live.trunk_class = static_cast<std::int64_t>(result.movement->trunk_class);
  if (std::isfinite(result.movement->trunk_deg)) live.trunk_deg = result.movement->trunk_deg;
  return live;
}

void compare(const std::vector<session::ReachTrialResult>& results, const LiveResults& live, RecordedReaches& recorded) {
  for (const session::ReachTrialResult& result : results) {
    const auto found = live.find({result.trial, result.attempt});
    if (found == live.end()) continue;
    ++recorded.live_results;
    if (found->second != live_of(result)) ++recorded.differing;
  }
}

core::Result<std::vector<PlacedStep>> read_steps(record::Recording& recording, LiveTrials& live,
                                                 const std::function<void(double)>& progress) {
  std::vector<PlacedStep> steps;
  while (true) {
    DTS_TRY_ASSIGN(auto item, recording.next());
    if (!item) break;
    if (recording.size() > 0) progress(static_cast<double>(recording.offset()) / static_cast<double>(recording.size()));
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

void add(const PlacedStep& placed, session::ReachResults& results) {
  if (const auto* reach = std::get_if<core::ReachEvent>(&placed.step)) results.take(*reach);
  if (const auto* movement = std::get_if<core::ClassEvent>(&placed.step)) results.take(*movement);
  if (const auto* trial = std::get_if<session::TrialEvent>(&placed.step)) results.take(*trial, placed.segment, placed.scan);
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
  DTS_TRY_ASSIGN(const auto steps, read_steps(recording, live, progress));
  RecordedReaches recorded;
  if (const auto& facts = recording.session()) recorded.person = session::person_of(facts->fields);
  session::ReachResults results(recorded.person, model);
  for (const PlacedStep& step : steps) {
    results.advance(step.segment, step.scan);
    compare(results.take_decided(), live.decided, recorded);  // uses only what was known at that time
    add(step, results);
  }
  results.finish();
  compare(results.take_decided(), live.decided, recorded);
  recorded.reaches = count_reaches(steps);
  recorded.trials = results.results();
  compare(recorded.trials, live.at_end, recorded);
  recorded.summary = results.summary();
  return recorded;
}

}  // namespace dts::lab::results
