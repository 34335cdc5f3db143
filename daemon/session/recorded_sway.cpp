// SPDX-License-Identifier: Apache-2.0
#include "session/recorded_sway.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "session/cop_trace.h"
#include "session/session_events.h"

namespace dts::session {
namespace {

using Key = std::pair<std::uint32_t, std::uint32_t>;  ///< Trial, attempt.

constexpr double kLeastStandingS = 10.0;  // for a recording without trials: a shorter time is a person who steps on and off
constexpr double kSteppingOnS = 1.0;      // as in the stage `steadiness`
constexpr double kSteppingOffS = 0.5;     // the load decreases before the centre of pressure becomes invalid
constexpr double kLongestGapS = 0.05;     // posturography sheet section 7: a gap up to this length is interpolated

/// The stream "cop" of a recording.
struct CopColumns {
  std::size_t stream = 0;
  std::size_t width = 0;
  std::size_t ml = 0;
  std::size_t ap = 0;
  std::optional<std::size_t> load;
  core::Rate rate;
  core::Rate raw_rate;
};

core::Result<CopColumns> find_cop(const record::Recording& recording) {
  const auto refuse = [](const std::string& what) {
    return core::fail(core::ErrorCode::NotFound, what,
                      "choose a recording of a floor platform; dtslab replay shows what a recording contains");
  };
  const auto stream = recording.find_stream("cop");
  if (!stream || !recording.streams()[*stream].rate) return refuse("the recording has no stream \"cop\"");
  const record::StreamInfo& info = recording.streams()[*stream];
  const auto column = [&info](const std::string& label) -> std::optional<std::size_t> {
    const auto found = std::ranges::find(info.channels, label, &record::ChannelInfo::label);
    if (found == info.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(found - info.channels.begin());
  };
  const auto ml = column("ml_mm");
  const auto ap = column("ap_mm");
  if (!ml || !ap) return refuse("stream \"cop\" has no channels ml_mm and ap_mm");
  core::Rate raw_rate = *info.rate;
  if (const auto raw = recording.find_stream("raw"); raw && recording.streams()[*raw].rate) raw_rate = *recording.streams()[*raw].rate;
  return CopColumns{.stream = *stream,
                    .width = info.channels.size(),
                    .ml = *ml,
                    .ap = *ap,
                    .load = column("load_n"),
                    .rate = *info.rate,
                    .raw_rate = raw_rate};
}

core::Status for_each(record::Recording& recording, double from, const std::function<void(double)>& progress,
                      const std::function<core::Status(const record::RecordedItem&)>& handle) {
  while (true) {
    DTS_TRY_ASSIGN(const auto item, recording.next());
    if (!item) return {};
    if (recording.size() > 0) progress(from + 0.5 * static_cast<double>(recording.offset()) / static_cast<double>(recording.size()));
    DTS_TRY(handle(*item));
  }
}

/// Collects trials from their events, like SwayResults.
class TrialSteps {
 public:
  core::Status add(const record::TimedEvent& timed) {
    const v1::Event& event = timed.event;
    if (event.has_trial()) return add_step(event, timed.time_s);
    if (event.has_sway()) return add_live(event);
    if (event.has_figure()) add_session_result(event.figure());
    return {};
  }
  /// Returns the trials in the order of their beginning, without those that were never measured.
  [[nodiscard]] RecordedStanding result() const {
    RecordedStanding standing;
    for (const auto& [key, trial] : trials_) {
      if (trial.outcome.empty() || trial.trial == 0) continue;
      standing.trials.push_back(trial);
      // The quality bits of the stream "cop" are not recorded, but their effect is in the daemon's recorded result.
      if (trial.live && trial.live->analysis)
        standing.trials.back().cop.flags = trial.live->analysis->flags & posturography::sway_flag::kDoubtful;
    }
    std::ranges::stable_sort(standing.trials, {}, [](const StandingTrial& trial) { return std::pair(trial.segment, trial.first_scan); });
    standing.live_results = session_results_;
    return standing;
  }
  [[nodiscard]] bool empty() const noexcept { return trials_.empty(); }

 private:
  core::Status add_step(const v1::Event& event, double time_s) {
    DTS_TRY_ASSIGN(const auto step, trial_of(event));
    const Key key{step.trial, step.attempt};
    if (step.trial == 0 || (trials_.size() >= SwayResults::kMostAttempts && !trials_.contains(key))) return {};
    StandingTrial& trial = trials_[key];
    using enum TrialEventKind;
    if (step.kind == Measure) {
      trial = {.trial = step.trial,
               .attempt = step.attempt,
               .block = step.block,
               .condition = step.condition,
               .labels = step.labels,
               .segment = event.segment(),
               .first_scan = {event.scan()},
               .end_scan = {event.scan()},
               .end_segment = event.segment(),
               .begin_s = time_s};
    } else if (step.kind == Done || step.kind == Redone || step.kind == Rejected || step.kind == Aborted) {
      const bool was_done = done_.contains(key);
      if (step.kind == Done) done_.insert(key);
      if (!was_done) {  // a trial that is voided after its end keeps its end
        trial.end_scan = {event.scan()};
        trial.end_segment = event.segment();
      }
      // A Done that was due before an undo may precede it in the file.
      if (step.kind != Done || trial.outcome.empty()) trial.outcome = name(step.kind);
    } else if (step.kind == Undone) {
      trial.outcome = done_.contains(key) ? name(Done) : "";
    }
    return {};
  }
  core::Status add_live(const v1::Event& event) {
    DTS_TRY_ASSIGN(auto live, sway_of(event));
    if (const auto trial = trials_.find({live.trial, live.attempt}); trial != trials_.end()) trial->second.live = std::move(live);
    return {};
  }
  void add_session_result(const v1::SessionResult& result) {
    if (!std::isfinite(result.value()) || session_results_.size() >= kMostResults) return;
    session_results_.push_back({.name = result.name(), .value = result.value(), .unit = result.unit(), .details = result.details()});
  }

  static constexpr std::size_t kMostResults = 10'000;
  std::set<Key> done_;  ///< Also if they were redone or rejected later.
  std::map<Key, StandingTrial> trials_;
  std::vector<SessionFigure> session_results_;
};

/// Appends sample `i` of `scans`.
void append(posturography::CopSeries& series, const record::RecordedScans& scans, std::size_t i, const CopColumns& cop) {
  const double* const sample = &scans.values[i * cop.width];
  series.ml_mm.push_back(sample[cop.ml]);
  series.ap_mm.push_back(sample[cop.ap]);
  series.load_n.push_back(cop.load ? sample[*cop.load] : std::nan(""));
}

void pad(posturography::CopSeries& series, std::size_t samples) {
  for (auto* column : {&series.ml_mm, &series.ap_mm, &series.load_n}) column->resize(samples, std::nan(""));
}

/// Copies the samples of every trial from the stream.
class TrialSamples {
 public:
  TrialSamples(std::vector<StandingTrial>& trials, const CopColumns& cop) : trials_(trials), ends_(trials.size()), cop_(cop) {
    for (StandingTrial& trial : trials_) trial.cop.rate_hz = cop.rate.hz();
  }

  core::Status add(const record::RecordedScans& scans) {
    for (std::size_t index = 0; index < trials_.size(); ++index) {
      StandingTrial& trial = trials_[index];
      if (scans.segment < trial.segment || scans.segment > trial.end_segment) continue;
      if (trial.problem.empty()) add(scans, trial, ends_[index]);
    }
    return {};
  }
  /// Adds what is missing at the ends of trials, as CopTrace does.
  void finish() {
    for (std::size_t index = 0; index < trials_.size(); ++index) {
      StandingTrial& trial = trials_[index];
      const std::size_t size = trial.cop.ml_mm.size();
      if (!trial.problem.empty() || ends_[index] <= size) continue;
      const std::size_t missing = ends_[index] - size;
      if (samples_ + missing > kMostStandingSamples) {
        give_up(trial);
        continue;
      }
      samples_ += missing;
      pad(trial.cop, ends_[index]);
    }
  }

 private:
  /// Locates samples by index in the trial's first segment, and by time after a gap. `end_place`: how many samples the trial should have;
  /// 0 as long as nothing of its last segment was read.
  void add(const record::RecordedScans& scans, StandingTrial& trial, std::size_t& end_place) {
    const std::uint64_t begin = cop_index(trial.first_scan, cop_.raw_rate, cop_.rate);
    const std::uint64_t end = cop_index(trial.end_scan, cop_.raw_rate, cop_.rate);
    const bool is_first = scans.segment == trial.segment;
    if (is_first && trial.cop.ml_mm.empty()) {  // more exact than the time of the event
      trial.begin_s = scans.first_time_s + (static_cast<double>(begin) - static_cast<double>(scans.first_scan.value)) / cop_.rate.hz();
    }
    const double first = is_first ? static_cast<double>(scans.first_scan.value) - static_cast<double>(begin)
                                  : std::round((scans.first_time_s - trial.begin_s) * cop_.rate.hz());
    if (!(std::abs(first) < kMostPlaces)) return give_up(trial);
    if (scans.segment == trial.end_segment) {
      const double places = first + static_cast<double>(end) - static_cast<double>(scans.first_scan.value);
      end_place = places < 0.0 ? 0 : static_cast<std::size_t>(std::min(places, kMostPlaces));
    }
    for (std::size_t i = 0; i < scans.count; ++i) {
      if (scans.segment == trial.end_segment && scans.first_scan.value + i >= end) break;
      const auto place = static_cast<std::int64_t>(first) + static_cast<std::int64_t>(i);
      if (place < std::ssize(trial.cop.ml_mm)) continue;  // before the trial
      const std::size_t size = trial.cop.ml_mm.size();
      const auto missing = static_cast<std::size_t>(place) - size;
      if (missing >= kMostStandingSamples || samples_ + missing >= kMostStandingSamples) return give_up(trial);
      samples_ += missing + 1;
      pad(trial.cop, size + missing);
      append(trial.cop, scans, i, cop_);
    }
  }
  static constexpr double kMostPlaces = 9e15;  // whole numbers below 2^53 are exact
  void give_up(StandingTrial& trial) {
    trial.problem = "the trial has more than " + std::to_string(kMostStandingSamples) + " samples, gaps included";
    samples_ -= trial.cop.ml_mm.size();
    trial.cop = {.rate_hz = trial.cop.rate_hz, .ml_mm = {}, .ap_mm = {}};
  }

  std::vector<StandingTrial>& trials_;
  std::vector<std::size_t> ends_;
  CopColumns cop_;
  std::size_t samples_ = 0;
};

/// Finds the periods in which a person stands on the plate, in a recording without trials.
class FreeStanding {
 public:
  FreeStanding(std::vector<StandingTrial>& trials, const CopColumns& cop)
      : trials_(trials), cop_(cop), longest_gap_(static_cast<std::size_t>(kLongestGapS * cop.rate.hz() + 1e-9)) {}

  core::Status add(const record::RecordedScans& scans) {
    for (std::size_t i = 0; i < scans.count; ++i) {
      const std::uint64_t index = scans.first_scan.value + i;
      if (scans.segment != segment_ || index != next_) finish();
      segment_ = scans.segment;
      next_ = index + 1;
      const double* const sample = &scans.values[i * cop_.width];
      const bool is_there = std::isfinite(sample[cop_.ml]) && std::isfinite(sample[cop_.ap]);
      gap_ = is_there ? 0 : gap_ + 1;
      if (gap_ > longest_gap_) finish();
      if (!is_there && current_.ml_mm.empty()) continue;
      if (current_.ml_mm.empty()) first_ = index;
      append(current_, scans, i, cop_);
      if (++samples_ > kMostStandingSamples) {
        return core::fail(core::ErrorCode::Unsupported, "more than " + std::to_string(kMostStandingSamples) + " samples of standing",
                          "record trials, or a shorter session");
      }
    }
    return {};
  }
  void finish() {
    const auto settling = static_cast<std::size_t>(kSteppingOnS * cop_.rate.hz());
    const auto leaving = static_cast<std::size_t>(kSteppingOffS * cop_.rate.hz());
    if (static_cast<double>(current_.ml_mm.size()) >= (kLeastStandingS + kSteppingOnS + kSteppingOffS) * cop_.rate.hz()) {
      pad(current_, current_.ml_mm.size() - leaving);
      for (auto* column : {&current_.ml_mm, &current_.ap_mm, &current_.load_n}) {
        column->erase(column->begin(), column->begin() + static_cast<std::ptrdiff_t>(settling));
      }
      current_.rate_hz = cop_.rate.hz();
      const std::uint64_t first = first_ + settling;
      trials_.push_back({.segment = segment_,
                         .first_scan = raw(first),
                         .end_scan = raw(first + current_.ml_mm.size()),
                         .end_segment = segment_,
                         .cop = std::move(current_)});
    } else {
      samples_ -= std::min(samples_, current_.ml_mm.size());
    }
    current_ = {};
  }

 private:
  [[nodiscard]] core::ScanIndex raw(std::uint64_t index) const {
    return {static_cast<std::uint64_t>(std::llround(static_cast<double>(index) * cop_.raw_rate.hz() / cop_.rate.hz()))};
  }

  std::vector<StandingTrial>& trials_;
  CopColumns cop_;
  std::size_t longest_gap_;
  posturography::CopSeries current_;
  std::uint32_t segment_ = 0;
  std::uint64_t first_ = 0;
  std::uint64_t next_ = 0;
  std::size_t gap_ = 0;
  std::size_t samples_ = 0;
};

template <class Reader>
core::Status read_samples(record::Recording& recording, const CopColumns& cop, Reader& reader,
                          const std::function<void(double)>& progress) {
  return for_each(recording, 0.5, progress, [&](const record::RecordedItem& item) -> core::Status {
    const auto* scans = std::get_if<record::RecordedScans>(&item);
    if (scans == nullptr || scans->stream != cop.stream) return {};
    return reader.add(*scans);
  });
}

}  // namespace

core::Result<RecordedStanding> read_recorded_standing(record::Recording& recording, const std::function<void(double)>& progress) {
  DTS_TRY_ASSIGN(const auto cop, find_cop(recording));
  TrialSteps steps;
  const auto done = for_each(recording, 0.0, progress, [&steps](const record::RecordedItem& item) -> core::Status {
    const auto* timed = std::get_if<record::TimedEvent>(&item);
    return timed == nullptr ? core::Status{} : steps.add(*timed);
  });
  if (!done) return tl::make_unexpected(done.error());
  RecordedStanding standing = steps.result();
  standing.raw_rate_hz = cop.raw_rate.hz();
  DTS_TRY(recording.rewind());
  if (steps.empty()) {
    FreeStanding reader(standing.trials, cop);
    DTS_TRY(read_samples(recording, cop, reader, progress));
    reader.finish();
  } else {
    TrialSamples reader(standing.trials, cop);
    DTS_TRY(read_samples(recording, cop, reader, progress));
    reader.finish();
  }
  return standing;
}

}  // namespace dts::session
