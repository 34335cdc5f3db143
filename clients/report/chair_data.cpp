// SPDX-License-Identifier: Apache-2.0
#include "report/chair_data.h"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "dts/wire/event_json.h"
#include "record/catalogue/catalogue.h"
#include "report/number_text.h"
#include "report/recorded_definitions.h"
#include "report/watched_recording.h"
#include "session/session_events.h"

namespace dts::report {
namespace {

constexpr double kReadShare = 0.9;   // fraction of the work, for the progress bar
constexpr double kBeforeCueS = 1.0;  // shown before the cue
constexpr double kMostBeforeCueS = 5.0;
constexpr double kBeforeOnsetS = 0.5;  // shown before P1, if that is earlier

core::ScanIndex earlier(core::ScanIndex scan, double seconds, double rate_hz) {
  const auto scans = static_cast<std::uint64_t>(seconds * rate_hz);
  return {scan.value > scans ? scan.value - scans : 0};
}

/// Shows the trial from shortly before the cue to its end; within the segment of the cue.
TraceWindow window_of(const session::RecordedReachTrial& trial, double raw_rate_hz) {
  TraceWindow window{.segment = trial.segment, .begin = earlier(trial.go, kBeforeCueS, raw_rate_hz), .cue = trial.go, .end = trial.end};
  if (trial.end_segment != trial.segment) window.end = {trial.go.value + static_cast<std::uint64_t>(10.0 * raw_rate_hz)};
  if (trial.result && trial.result->reach) {
    const core::ScanIndex before_onset = earlier(trial.result->reach->p1.scan, kBeforeOnsetS, raw_rate_hz);
    window.begin = std::clamp(before_onset, earlier(trial.go, kMostBeforeCueS, raw_rate_hz), window.begin);
  }
  return window;
}

double raw_rate_of(const record::Recording& recording) {
  for (const char* name : {"raw", "transient"}) {
    const auto stream = recording.find_stream(name);
    if (stream && recording.streams()[*stream].rate) return recording.streams()[*stream].rate->hz();
  }
  return 0.0;
}

void add_trials(session::RecordedReaches& reaches, std::vector<TransientTrace>& traces, std::uint32_t part_number,
                const WatchedRecording& recording, double raw_rate_hz, ChairData& chair) {
  for (std::size_t index = 0; index < reaches.attempts.size(); ++index) {
    ChairTrial trial{.recorded = std::move(reaches.attempts[index]),
                     .part = chair.parts.size() - 1,
                     .trace = std::move(traces[index]),
                     .raw_rate_hz = raw_rate_hz};
    const std::string* corrected = chair.corrections.outcome(part_number, trial.recorded.trial, trial.recorded.attempt);
    if (corrected != nullptr && *corrected != trial.recorded.outcome)
      trial.recorded_outcome = std::exchange(trial.recorded.outcome, *corrected);
    trial.cue_utc_ns = utc_of(recording.host_time_ns(trial.recorded.segment, trial.recorded.go, raw_rate_hz), recording.session());
    chair.trials.push_back(std::move(trial));
  }
}

core::Status read_chair_part(const std::string& path, Waiting& waiting, const Share& share, ChairData& chair,
                             std::vector<session::SessionFigure>& live) {
  const auto at = [&share](double fraction) { return share.begin + (share.end - share.begin) * fraction; };
  DTS_TRY_ASSIGN(const auto opened, open_part(path, waiting, {.begin = at(0.0), .end = at(0.3)}, chair));
  // Each part is judged by its own model, as dtsd did: a resumed session may have got another one.
  auto model = opened->session() ? recorded_trunk_model(*opened->session()) : std::nullopt;
  WatchedRecording recording(*opened, [&waiting] { return waiting.is_wanted(); });
  auto reaches = session::read_recorded_reaches(recording, model ? &*model : nullptr,
                                                [&](double fraction) { waiting.report({.begin = at(0.3), .end = at(0.6)}, fraction); });
  if (!waiting.is_wanted()) return interrupted();
  if (!reaches) return tl::make_unexpected(reaches.error());
  const double raw_rate_hz = raw_rate_of(recording);
  std::vector<TraceWindow> windows;
  for (const session::RecordedReachTrial& trial : reaches->attempts) windows.push_back(window_of(trial, raw_rate_hz));
  auto traces = read_traces(recording, windows, [&](double fraction) { waiting.report({.begin = at(0.6), .end = at(1.0)}, fraction); });
  if (!waiting.is_wanted()) return interrupted();
  if (!traces) return tl::make_unexpected(traces.error());
  if (chair.parts.size() == 1) chair.model = std::move(model);
  chair.reaches += reaches->reaches;
  chair.person = reaches->person;
  if (reaches->scale && !chair.scale) {
    chair.scale = reaches->scale;
    chair.scale_part = chair.parts.size() - 1;
  }
  add_trials(*reaches, *traces, opened->session() ? opened->session()->part : 1, recording, raw_rate_hz, chair);
  live = std::move(reaches->live_summary);
  return {};
}

void name_chair_pages(std::vector<ChairTrial>& trials) {
  std::set<std::string> taken{"session"};
  for (ChairTrial& trial : trials) {
    std::string name = "trial-" + two_digits(trial.recorded.trial);
    if (trial.recorded.attempt > 1) name += "-attempt-" + std::to_string(trial.recorded.attempt);
    trial.page = name;
    for (std::uint64_t again = 2; !taken.insert(trial.page).second; ++again) trial.page = name + "-part-" + std::to_string(again);
  }
}

/// Summarises the valid trials as the daemon does. `live`: what it recorded for the last part.
void summarise_chair(ChairData& chair, const std::vector<session::SessionFigure>& live) {
  std::vector<session::ReachTrialResult> results;
  for (const ChairTrial& trial : chair.trials) {
    if (trial.is_kept()) results.push_back(*trial.recorded.result);
    if (trial.recorded.is_compared) ++chair.compared;
    if (trial.recorded.differs) ++chair.differing;
  }
  chair.targets = session::summarize_targets(results);
  // The protocol may ask for the targets in any order; the nearest is first, a trial without a target last.
  std::ranges::stable_sort(chair.targets, {}, [](const session::TargetSummary& target) {
    return target.target_cm.value_or(std::numeric_limits<double>::infinity());
  });
  chair.summary = session::summarize(results, chair.person);
  const auto is_corrected = [](const ChairTrial& trial) { return !trial.recorded_outcome.empty(); };
  // A resumed session has results for its parts; only results for the whole session are comparable with those computed here.
  if (chair.parts.size() != 1 || std::ranges::any_of(chair.trials, is_corrected)) return;
  for (const session::SessionFigure& result : live) {
    const auto found = std::ranges::find(chair.summary, result.name, &session::SessionFigure::name);
    if (found != chair.summary.end() && !is_same_value(found->value, result.value)) chair.differing_results.push_back(result.name);
  }
}

}  // namespace

bool ChairTrial::is_valid() const {
  return is_kept() && record::is_valid({.outcome = recorded.outcome, .result = wire::to_json(session::to_event(*recorded.result, ""))});
}

std::string ChairTrial::number() const {
  return std::to_string(recorded.trial) + (recorded.attempt > 1 ? ", attempt " + std::to_string(recorded.attempt) : "");
}

core::Result<ChairData> read_chair_session(const ReportSource& source, const ReportProgress& progress) {
  ChairData chair;
  chair.software = source.software;
  chair.for_record = source.for_record;
  Waiting waiting(progress);
  const std::vector<std::string> files = leading_files(source.files);
  std::vector<session::SessionFigure> live;
  const double share = kReadShare / static_cast<double>(files.size());
  for (std::size_t part = 0; part < files.size(); ++part) {
    const double begin = share * static_cast<double>(part);
    DTS_TRY(read_chair_part(files[part], waiting, {.begin = begin, .end = begin + share}, chair, live));
  }
  name_chair_pages(chair.trials);
  summarise_chair(chair, live);
  return chair;
}

}  // namespace dts::report
