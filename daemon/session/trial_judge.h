// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "core/block.h"
#include "core/event.h"
#include "core/units.h"
#include "dts/v1/stream.pb.h"
#include "session/figure.h"
#include "session/trial_run.h"

namespace dts::session {

/// The result of a trial as an event, without its position.
struct TrialResultEvent {
  std::uint32_t trial = 0;
  std::uint32_t attempt = 1;
  v1::Event event;
};

/// Computes the results of one kind of task from what a session records: events and the centre of pressure from the pipeline, steps of the
/// trials from the control thread. One session may have several judges. Thread: one at a time; long analyses run on a worker.
///
///     take, advance ... take, advance      finish      wait (or not is_analysing)
///         take_results ...                                 take_results, final_results, summary
class TrialJudge {
 public:
  TrialJudge() = default;
  virtual ~TrialJudge() = default;
  TrialJudge(const TrialJudge&) = delete;
  TrialJudge& operator=(const TrialJudge&) = delete;

  /// Processes an event of the pipeline.
  virtual void take(const core::Event&) {}
  /// Processes a block of the stream "cop".
  virtual void take(const core::Block&) {}
  /// Processes a step of a trial at its scan of the raw stream.
  virtual void take(const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan) = 0;
  /// Everything before `scan` of `segment` was passed to `take`.
  virtual void advance(std::uint32_t /*segment*/, core::ScanIndex /*scan*/) {}
  /// Ends all remaining trials at the end of the session.
  virtual void finish() = 0;
  /// Returns whether the analysis of an ended trial is not done yet.
  [[nodiscard]] virtual bool is_analysing() const { return false; }
  /// Waits until the analyses of all ended trials are done.
  virtual void wait() const {}

  /// Returns the results that are known since the last call, in the order of the trials.
  [[nodiscard]] virtual std::vector<TrialResultEvent> take_results() = 0;
  /// Returns the results that the end of the session has changed.
  [[nodiscard]] virtual std::vector<TrialResultEvent> final_results() const { return {}; }
  /// Returns the results of the whole session.
  [[nodiscard]] virtual std::vector<SessionFigure> summary() const = 0;
};

}  // namespace dts::session
