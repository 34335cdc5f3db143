// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/event.h"
#include "core/rate.h"
#include "pipeline/stage_state.h"
#include "posturography/butterworth.h"
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
class SwayWatch {
 public:
  using Events = core::BoundedEvents<core::SwayEvent, core::kMaxSwaysPerFrame>;
  static constexpr std::size_t kPasses = 2;
  static constexpr std::size_t kStateSize =
      10 + 2 * kPasses * posturography::CausalLowPass::kStateSize + posturography::RunningSwaySums::kStateSize;
  static constexpr double kAnalysisRateHz = 100.0;
  static constexpr double kLongestGapMs = 50.0;  ///< A longer gap is not interpolated: posturography sheet section 7.

  /// Measuring time of a trial, as indices.
  struct Trial {
    std::uint32_t number = 0;  ///< 0: none.
    std::uint64_t begin = 0;
    std::uint64_t end = 0;  ///< First index after the window.
  };

  /// Sets the parameters. Also forgets the trial.
  void prepare(const core::Rate& rate, double every_ms, double settle_ms) noexcept;
  /// Sets the trial from the next index on; ends the window of another trial. If only the end differs, the window continues.
  void expect(const Trial& trial, Events& events) noexcept;
  /// Processes index `now`, which must follow the last one; a value that is not finite is missing. Events contain indices in place of
  /// scans. Realtime-safe: yes.
  void process(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept;
  /// Forgets the signal but keeps the trial.
  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  /// Restores a state; returns false if a value is impossible, with the watch as after `reset`. `trial` must be the trial set at `save`.
  [[nodiscard]] bool restore(StateReader& reader, const Trial& trial) noexcept;

 private:
  enum class Window : std::uint8_t { None = 0, Free = 1, OfTrial = 2 };
  using Filter = std::array<posturography::CausalLowPass, kPasses>;

  void miss(std::uint64_t now, Events& events) noexcept;
  void bridge(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept;
  void settle(std::uint64_t now, double ml_mm, double ap_mm) noexcept;
  void lose(std::uint64_t now, Events& events) noexcept;
  void measure(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept;
  void follow_trial(std::uint64_t described, Events& events) noexcept;
  void open(Window window, std::uint64_t described) noexcept;
  void close(Events& events) noexcept;
  void report(Events& events) noexcept;

  std::uint64_t divisor_ = 1;
  std::uint64_t every_ = 50;
  std::uint64_t settle_ = 100;
  std::uint64_t longest_gap_ = 5;
  std::uint64_t lag_ = 8;
  Trial trial_;

  bool is_standing_ = false;  ///< The filters run.
  std::uint64_t since_ = 0;   ///< Index since which a person stands.
  std::uint64_t gap_ = 0;     ///< Missing samples in a row, waiting for the end of the gap.
  double last_ml_mm_ = 0.0;   ///< The newest valid sample.
  double last_ap_mm_ = 0.0;
  Filter ml_filter_;
  Filter ap_filter_;

  Window window_ = Window::None;
  std::uint64_t first_ = 0;   ///< First index of the window.
  std::uint64_t due_ = 0;     ///< Index of the next event.
  std::uint64_t newest_ = 0;  ///< Newest index in the sums.
  bool has_news_ = false;     ///< The sums changed since the last event.
  posturography::RunningSwaySums sums_;
};

}  // namespace dts::pipeline
