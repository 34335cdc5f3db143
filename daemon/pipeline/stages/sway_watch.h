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

/// The work of stage `steadiness`, sample by sample: bridges gaps, filters, decimates, sums over windows. Knows samples by their index in
/// its input; whoever knows scans of the rig translates.
///
///     sample --gap of up to 50 ms: held back, then interpolated--> lp10, causal, twice --every n-th--> sums of the window --> event
///            --longer: the filter settles anew
///
/// The low-pass is run over twice, both times forward: -6 dB at 10 Hz as the zero-phase one of the final values, or the paths would differ
/// by a percent. A filtered sample describes the one `lag` before it (the group delay near DC, 80 ms): running values are of the same time
/// as the final ones. Every index passes once and in order; those of a possible gap as soon as it is known what it was.
class SwayWatch {
 public:
  using Events = core::BoundedEvents<core::SwayEvent, core::kMaxSwaysPerFrame>;
  static constexpr std::size_t kPasses = 2;
  static constexpr std::size_t kStateSize =
      10 + 2 * kPasses * posturography::CausalLowPass::kStateSize + posturography::RunningSwaySums::kStateSize;
  static constexpr double kAnalysisRateHz = 100.0;
  static constexpr double kLongestGapMs = 50.0;  ///< That is interpolated: posturography sheet section 7.

  /// Measuring time of a trial, as indices.
  struct Trial {
    std::uint32_t number = 0;  ///< 0: none.
    std::uint64_t begin = 0;
    std::uint64_t end = 0;  ///< First that does not count.
  };

  /// Also forgets the trial.
  void prepare(const core::Rate& rate, double every_ms, double settle_ms) noexcept;
  /// From the next index on; what runs for another trial ends. The same trial with another end goes on.
  void expect(const Trial& trial, Events& events) noexcept;
  /// Takes index `now`, the one after the last; what is not finite is missing. Events have indices for scans. Realtime-safe: yes.
  void take(std::uint64_t now, double ml_mm, double ap_mm, Events& events) noexcept;
  /// Forgets the signal, not the trial.
  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  /// false: something is impossible; the watch is then as after `reset`. `trial` is the one that was expected at `save`.
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
  void tell(Events& events) noexcept;

  std::uint64_t divisor_ = 1;
  std::uint64_t every_ = 50;
  std::uint64_t settle_ = 100;
  std::uint64_t longest_gap_ = 5;
  std::uint64_t lag_ = 8;
  Trial trial_;

  bool is_standing_ = false;  ///< The filters run.
  std::uint64_t since_ = 0;   ///< Somebody stands since this index.
  std::uint64_t gap_ = 0;     ///< Samples missing in a row, held back.
  double last_ml_mm_ = 0.0;   ///< The newest there was.
  double last_ap_mm_ = 0.0;
  Filter ml_filter_;
  Filter ap_filter_;

  Window window_ = Window::None;
  std::uint64_t first_ = 0;   ///< Of the window.
  std::uint64_t due_ = 0;     ///< When to tell again.
  std::uint64_t newest_ = 0;  ///< That counts.
  bool has_news_ = false;     ///< Something counts that was not told.
  posturography::RunningSwaySums sums_;
};

}  // namespace dts::pipeline
