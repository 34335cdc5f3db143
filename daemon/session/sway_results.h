// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/block.h"
#include "core/result.h"
#include "core/units.h"
#include "core/worker.h"
#include "dts/v1/stream.pb.h"
#include "posturography/analysis.h"
#include "session/cop_trace.h"
#include "session/figure.h"
#include "session/trial_run.h"

namespace dts::session {

/// The result of one trial of quiet standing.
struct SwayTrialResult {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};  ///< eyes=open, feet=two
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;     ///< In the rig's raw stream: the first scan of the measurement,
  core::ScanIndex end_scan;       ///< and its end (exclusive),
  std::uint32_t end_segment = 0;  ///< in this segment: differs from `segment` if the trial has gaps.
  std::optional<posturography::Analysis> analysis{};
  std::optional<v1::SteadinessDecision> decision{};  ///< Of the rig's steadiness model; absent: it has none for this trial.
  std::string problem{};                             ///< Why there is no analysis.
  std::optional<double> mean_load_n{};               ///< In the trial's event only if the platform is calibrated for two feet.
};

/// Returns results over all valid trials: the mean of each core measure by condition ("eyes-open-two-feet/MVELO"), and the Romberg quotient
/// ("romberg/feet=two/MVELO") of two conditions of equal duration that differ only in the label eyes = open, closed. With several such
/// conditions for the same other labels, there is no quotient: the choice between them would be arbitrary.
[[nodiscard]] std::vector<SessionFigure> sway_summary(const std::vector<SwayTrialResult>& trials);

struct MissingQuotient {
  std::string stance;  ///< "feet=two"; may be empty.
  std::string reason;
};
/// Returns the stances that have trials with eyes open and with eyes closed, but no Romberg quotient. `trials`: all, also those that do not
/// count, without their analysis.
[[nodiscard]] std::vector<MissingQuotient> missing_quotients(const std::vector<SwayTrialResult>& trials);

/// Computes results from the centre of pressure and the events of a protocol, with the report's definition (lp10, 100 Hz). Depends only on
/// its inputs, so that daemon, report and laboratory agree on the same recording. Memory is bounded: keeps at most `CopTrace::kMostSamples`
/// samples, and those of trials that wait for their analysis. Thread: one at a time; the analyses, which need up to 0.5 s each, run on the
/// worker.
class SwayResults {
 public:
  static constexpr std::size_t kMostAttempts = std::size_t{2} * kMostTrials;

  /// `worker` outlives this object.
  SwayResults(core::Rate raw_rate, core::Rate cop_rate, core::Worker& worker);

  /// Adds a block of the stream "cop".
  void take(const core::Block& cop);
  /// Processes an event of the protocol at its scan of the raw stream.
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  /// Ends the remaining trials at the end of the session, even if their last samples are missing.
  void finish();

  /// Returns whether the analysis of an ended trial is not done yet.
  [[nodiscard]] bool is_analysing() const;
  /// Waits until the analyses of all ended trials are done.
  void wait() const;

  /// Returns the trials decided since the last call, in the order of their ends. Leaves out trials that became void before all their
  /// samples had arrived, and returns them if that is undone. Returns the others also if they became void during their analysis: whether a
  /// trial has values must not depend on the speed of the machine. A trial that is redone or rejected no longer counts.
  [[nodiscard]] std::vector<SwayTrialResult> take_decided();
  /// Returns the trials that `take_decided` has returned and that still count.
  [[nodiscard]] std::vector<SwayTrialResult> counting() const;
  /// Returns `sway_summary` of these trials.
  [[nodiscard]] std::vector<SessionFigure> summary() const { return sway_summary(counting()); }

 private:
  struct Analysed {
    posturography::Analysis analysis;
    std::optional<double> mean_load_n;
  };
  using Key = std::pair<std::uint32_t, std::uint32_t>;  ///< Trial, attempt.
  /// Waiting: for the last samples. Ended: the analysis runs, or its result was not yet taken. Dropped: its samples are not kept any more.
  enum class State : std::uint8_t { None, Measuring, Waiting, Ended, Decided, Dropped };
  struct Attempt {
    SwayTrialResult result;
    State state = State::None;
    std::optional<TracePlace> voided{};  ///< Where it was redone, rejected or aborted; nothing: it is valid.
  };
  struct Ended {
    Key key;
    std::future<core::Result<Analysed>> analysis;  ///< Absent: the result has a problem.
  };

  [[nodiscard]] static core::Result<Analysed> analyse(const CopCut& samples);
  static void begin(Attempt& attempt, const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  void undo(const Key& key);
  void end_complete();
  void end_trial(const Key& key, Attempt& attempt);

  core::Rate raw_rate_;
  core::Worker& worker_;
  CopTrace trace_;
  std::uint64_t last_word_scans_;
  std::uint64_t undo_samples_;  ///< So long, gaps included, the samples of a void attempt are kept.
  std::map<Key, Attempt> attempts_;
  std::vector<Key> open_;    ///< Being measured, or waiting for their last samples.
  std::deque<Ended> ended_;  ///< Not yet taken, in the order of their ends.
};

}  // namespace dts::session
