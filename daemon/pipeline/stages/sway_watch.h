// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/event.h"
#include "core/rate.h"
#include "pipeline/stage_state.h"
#include "posturography/butterworth.h"
#include "posturography/recent_sway.h"
#include "posturography/running_sway.h"

namespace dts::pipeline {

/// The work of stage `steadiness` per sample: bridges gaps, filters, decimates, and sums over windows. Uses sample indices of its input;
/// the stage converts them to scans of the rig.
///
///     sample --gap of up to 50 ms: held back, then interpolated--> lp10, causal, twice --every n-th--> sums of the window --> event
///            --longer: the filter starts again
///
/// The low-pass runs twice, both times forward, for -6 dB at 10 Hz like the zero-phase filter of the final values; otherwise path lengths
/// would differ by a percent. A filtered sample describes the sample `lag` before it (the group delay near DC, 80 ms), so that running and
/// final values refer to the same time. Every index is processed once and in order; samples in a possible gap wait until its length is
/// known.
///
/// Outside a trial, the transient of stepping on is left out. A window begins when the person has stood still for `settle_ms`:
///
///     load   ____/^^\/\___________   within 20 % of the load at the beginning of this time
///     COP    --/\/^\_/~~~~~~~~~~~~   within 40 mm of where it was, in both axes
///            step on    |-settle-| window
///
/// It ends when the load differs by more than 20 % from the load that settled: the second foot, or a step off. A person who sways more
/// than 40 mm is measured 5 s after the last change of load. The limits are wide: quiet standing moves the COP by
/// less than 20 mm in 1 s and the load by 1 %; stepping on moves the COP across the plate and the load by 30 % at least.
class SwayWatch {
 public:
  using Events = core::BoundedEvents<core::SwayEvent, core::kMaxSwaysPerFrame>;
  static constexpr std::size_t kPasses = 2;
  static constexpr double kAnalysisRateHz = 100.0;
  static constexpr double kLongestGapMs = 50.0;  ///< A longer gap is not interpolated: posturography sheet section 7.

  static constexpr double kSteadyLoad = 0.2;  ///< Share of the load by which it may change.
  static constexpr double kSteadyMm = 40.0;
  static constexpr double kLongestTransientMs = 5000.0;  ///< After the last change of load.

  struct Sample {
    double ml_mm = 0.0;
    double ap_mm = 0.0;
    double load_n = 0.0;  ///< NaN: unknown, does not count as a change.
  };
  /// Measuring time of a trial, as indices.
  struct Trial {
    std::uint32_t number = 0;  ///< 0: none.
    std::uint64_t begin = 0;
    std::uint64_t end = 0;  ///< First index after the window.
  };

  /// Sets the parameters. Also forgets the trial.
  void prepare(const core::Rate& rate, double every_ms, double settle_ms);
  /// Sets the trial from the next index on; ends the window of another trial, and for a new trial also a window without a trial. If only
  /// the end differs, the window continues. If the trial before this one is set again (a redo or reject is undone), its window continues
  /// with all samples, also those in between, and also if it was to begin in between.
  void expect(const Trial& trial, Events& events) noexcept;
  /// Ends a window without a trial, for the start of a session. The next one begins at once if the person stands still.
  void restart(Events& events) noexcept;
  /// Processes index `now`, which must follow the last one; a value that is not finite is missing. Events contain indices in place of
  /// scans. Realtime-safe: yes.
  void process(std::uint64_t now, const Sample& sample, Events& events) noexcept;
  /// Forgets the signal but keeps the trial.
  void reset() noexcept;
  [[nodiscard]] std::size_t state_size() const noexcept { return kOldStateSize + state_added_since_0_1(); }
  [[nodiscard]] std::size_t state_added_since_0_1() const noexcept { return kSteadyStateSize + recent_.state_size() + kVoidedStateSize; }
  void save(StateWriter& writer) const noexcept;
  /// Restores a state; returns false if a value is impossible, with the watch as after `reset`. `trial` must be the trial set at `save`.
  [[nodiscard]] bool restore(StateReader& reader, const Trial& trial) noexcept;

 private:
  enum class Window : std::uint8_t { None = 0, Free = 1, OfTrial = 2 };
  using Filter = std::array<posturography::CausalLowPass, kPasses>;
  static constexpr std::size_t kOldStateSize =
      10 + 2 * kPasses * posturography::CausalLowPass::kStateSize + posturography::RunningSwaySums::kStateSize;
  static constexpr std::size_t kSteadyStateSize = 6;
  static constexpr std::size_t kVoidedStateSize = 4 + posturography::RunningSwaySums::kStateSize;

  void miss(std::uint64_t now, Events& events) noexcept;
  void bridge(std::uint64_t now, const Sample& sample, Events& events) noexcept;
  void settle(std::uint64_t now, const Sample& sample) noexcept;
  void lose(std::uint64_t now, Events& events) noexcept;
  void measure(std::uint64_t now, const Sample& sample, Events& events) noexcept;
  void check_load(std::uint64_t now, double load_n, Events& events) noexcept;
  void check_place(std::uint64_t described, double ml_mm, double ap_mm) noexcept;
  [[nodiscard]] bool is_still(std::uint64_t described) const noexcept;
  void follow_trial(std::uint64_t described, Events& events) noexcept;
  void open(Window window, std::uint64_t described) noexcept;
  void close(Events& events) noexcept;
  void make_void() noexcept;
  void resume() noexcept;
  [[nodiscard]] bool has_voided_begun() const noexcept;
  void report(Events& events) noexcept;

  std::uint64_t divisor_ = 1;
  std::uint64_t every_ = 50;  ///< From one event to the next: a multiple of `divisor_`.
  std::uint64_t settle_ = 100;
  std::uint64_t longest_transient_ = 500;
  std::uint64_t longest_gap_ = 5;
  std::uint64_t lag_ = 8;
  double load_step_ = 0.0;  ///< Share of a difference in load by which `steady_load_n_` follows at each sample.
  Trial trial_;

  bool is_standing_ = false;  ///< The filters run.
  std::uint64_t since_ = 0;   ///< Index since which a person stands.
  std::uint64_t gap_ = 0;     ///< Missing samples in a row, waiting for the end of the gap.
  double last_ml_mm_ = 0.0;   ///< The newest valid sample.
  double last_ap_mm_ = 0.0;
  std::uint64_t loaded_since_ = 0;  ///< Index since which the load has not changed.
  double first_load_n_ = 0.0;       ///< The load at that index; 0: not known yet.
  double steady_load_n_ = 0.0;      ///< Follows the load for `settle_` after that index, then stays.
  std::uint64_t still_since_ = 0;   ///< Index since which the filtered COP has stayed at its place,
  double still_ml_mm_ = 0.0;        ///< which is this.
  double still_ap_mm_ = 0.0;
  Filter ml_filter_;
  Filter ap_filter_;

  Window window_ = Window::None;
  std::uint64_t first_ = 0;               ///< First index of the window.
  std::uint64_t due_ = 0;                 ///< Index of the next event.
  std::uint64_t newest_ = 0;              ///< Newest index in the sums.
  bool has_news_ = false;                 ///< The sums changed since the last event.
  posturography::RunningSwaySums sums_;   ///< Of a trial.
  posturography::RecentSwaySums recent_;  ///< Without a trial, in chunks from one event to the next.

  Trial voided_;                                ///< The trial that was replaced last: its window continues here, in case that is undone.
  std::uint64_t voided_first_ = 0;              ///< First index of its window; before `voided_.begin`: it has not begun.
  posturography::RunningSwaySums voided_sums_;  ///< Of its window.
};

}  // namespace dts::pipeline
