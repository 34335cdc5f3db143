// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/block.h"
#include "core/units.h"
#include "posturography/analysis.h"
#include "session/cop_trace.h"
#include "session/figure.h"
#include "session/trial_run.h"

namespace dts::session {

/// What came of one trial of quiet standing.
struct SwayTrialResult {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  std::string condition{};
  std::vector<std::pair<std::string, std::string>> labels{};  ///< eyes=open, feet=two
  std::uint32_t segment = 0;
  core::ScanIndex first_scan;  ///< Of the rig's raw stream: from here on it counted,
  core::ScanIndex end_scan;    ///< up to here, exclusive;
  std::uint32_t end_segment = 0;  ///< of this segment: another than `segment` when gaps divide the trial.
  std::optional<posturography::Analysis> analysis{};
  std::string problem{};  ///< Why there is none.
};

/// Figures of all trials that count, and are valid: the mean of each core measure by condition ("eyes-open-two-feet/MVELO"), and the
/// Romberg quotient of the two conditions that differ in nothing but the label eyes = open, closed, and are equally long
/// ("romberg/feet=two/MVELO"). More than two of the same other labels: none, it would be anybody's choice.
[[nodiscard]] std::vector<SessionFigure> sway_summary(const std::vector<SwayTrialResult>& trials);

/// Turns the centre of pressure and the steps of a protocol into results by the report's definition (lp10, 100 Hz). A pure function of what
/// it is told, so that daemon, report and laboratory say the same of the same recording. Memory is bounded: of a trial at most
/// `CopTrace::kMostSamples` are kept. Thread: one at a time.
class SwayResults {
 public:
  static constexpr std::size_t kMostAttempts = std::size_t{2} * kMostTrials;

  SwayResults(core::Rate raw_rate, core::Rate cop_rate);

  /// A block of the stream "cop".
  void take(const core::Block& cop);
  /// A step of the protocol, at its scan of the raw stream.
  void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  /// The session is over: trials whose last samples did not come are decided without them.
  void finish();

  /// Of trials that were decided since the last call, oldest first. A trial that is redone or rejected later is void in the summary.
  [[nodiscard]] std::vector<SwayTrialResult> take_decided();
  [[nodiscard]] std::vector<SessionFigure> summary() const;

 private:
  using Key = std::pair<std::uint32_t, std::uint32_t>;                    ///< Trial, attempt.
  enum class State : std::uint8_t { Measuring, Waiting, Decided, Void };  ///< Waiting: for the last samples.
  struct Attempt {
    SwayTrialResult result;
    State state = State::Void;
  };

  static void begin(Attempt& attempt, const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan);
  void decide();
  void finish_trial(Attempt& attempt);

  core::Rate raw_rate_;
  CopTrace trace_;
  std::uint64_t last_word_scans_;
  std::map<Key, Attempt> attempts_;
  std::vector<Key> open_;  ///< Measured, or waiting for their last samples.
  std::vector<SwayTrialResult> decided_;
};

}  // namespace dts::session
