// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "core/event.h"
#include "core/reach.h"
#include "pipeline/reach/reach_record.h"
#include "pipeline/reach/rest_detector.h"
#include "pipeline/reach/smoother.h"
#include "pipeline/reach/transient_history.h"

namespace dts::pipeline {

/// Finds reaches in the smoothed transient with the states of reach-model section 5.
///
///     Absent -> Settle -> Quiet -+-> Ris -> Rise -> Return -> Settle
///                                +---------^  ^-------+          any -> Absent when the person leaves the seat
///
/// A second reach may begin right after the first has returned: Settle -> Rise, with the rest before the first.
class ReachMachine {
 public:
  using Events = core::BoundedEvents<core::ReachEvent, core::kMaxReachesPerFrame>;
  static constexpr std::size_t kStateSize = TransientHistory::kStateSize + RestDetector::kStateSize + ReachRecord::kStateSize + 16;

  void prepare(double rate_hz, const SeatLimits& limits) noexcept;
  /// Processes the next sample. Events contain the sample's number (`TransientHistory`) in place of a scan; the stage converts it.
  /// Realtime-safe: yes.
  void step(const ReachSample& sample, Events& events) noexcept;
  [[nodiscard]] std::uint64_t now() const noexcept { return history_.now(); }
  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  enum class State : std::uint8_t { Absent, Settle, Quiet, Ris, Rise, Return };

  [[nodiscard]] std::uint64_t ticks(double seconds) const noexcept { return static_cast<std::uint64_t>(seconds * rate_hz_ + 0.5); }
  void enter(State state) noexcept;
  void count_doubts(const ReachSample& sample) noexcept;
  [[nodiscard]] bool has_left(const ReachSample& sample) noexcept;
  void leave(const ReachSample& sample, Events& events) noexcept;

  void settle(const ReachSample& sample, Events& events) noexcept;
  void rest_until(std::uint64_t tick) noexcept;
  void open_again(Events& events, const ReachSample& sample) noexcept;

  void watch_rest(const ReachSample& sample, Events& events) noexcept;
  void open(const ReachSample& sample, bool is_falling, Events& events) noexcept;
  void find_lowest(const ReachSample& sample, Events& events) noexcept;
  void begin_rise(const ReachSample& sample, Events& events) noexcept;
  void find_highest(const ReachSample& sample, Events& events) noexcept;
  [[nodiscard]] bool is_false_rise(const ReachSample& sample, Events& events) noexcept;
  [[nodiscard]] bool has_passed_highest(const ReachSample& sample) const noexcept;
  void await_return(const ReachSample& sample, Events& events) noexcept;
  /// Returns whether the transient has been within `limit_mm` of rest for `seconds`.
  [[nodiscard]] bool is_back(const ReachSample& sample, double limit_mm, double seconds) noexcept;

  /// Returns whether the transient has stayed at one level for 1 s: a new posture and not a movement.
  [[nodiscard]] bool is_steady() const noexcept;
  [[nodiscard]] double lowest_since(std::uint64_t tick) const noexcept;
  void rest_anew(const ReachSample& sample) noexcept;

  void cancel(Events& events) noexcept;
  void finish(std::uint16_t flags, Events& events) noexcept;
  void report(core::ReachStep step, Events& events) const noexcept;
  template <class Self, class Archive>
  static void exchange(Self& self, Archive& archive) noexcept;

  double rate_hz_ = 100.0;
  SeatLimits limits_;
  TransientHistory history_;
  RestDetector rest_;
  ReachRecord reach_;
  State state_ = State::Absent;
  std::uint32_t number_ = 0;
  bool is_between_ = false;    ///< A reach has just returned; another may follow before the new rest is known ...
  TickPoint between_;          ///< ... from the lowest point since then.
  bool is_final_ = false;      ///< The reach's Final was reported; the reach may still continue.
  std::uint64_t below_ = 0;    ///< Samples in a row below the rest's band ...
  std::uint64_t above_ = 0;    ///< ... above it ...
  std::uint64_t back_ = 0;     ///< ... and back at rest.
  std::uint64_t light_ = 0;    ///< Samples in a row with nearly nothing on the seat.
  std::uint64_t started_ = 0;  ///< Tick at which the reach, or its continuation, was detected.
  double reported_mm_ = 0.0;   ///< The extreme that was reported last.
  bool is_reported_ = false;
  std::uint64_t substituted_ = 0;  ///< Number of samples, in the reach and the rest before it, with a replaced sensor ...
  std::uint64_t at_end_ = 0;       ///< ... or with a sensor at the end of its range.
  bool is_untared_ = false;
};

}  // namespace dts::pipeline
