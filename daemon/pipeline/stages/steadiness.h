// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "pipeline/stage.h"
#include "pipeline/stages/sway_watch.h"

namespace dts::pipeline {

/// Reports running values of quiet standing (`core::SwayEvent`; posturography sheet sections 2 and 3, "live") from the causally filtered
/// centre of pressure at 100 Hz, or the nearest rate that divides the input's: over a window, every 0.5 s and at its end. Input:
/// ml_mm, ap_mm, load_n. Makes no stream.
///
/// A window is a trial's measuring time so far, from `SteadinessWindows`. Without a trial, it is the last 30 s at most
/// (`core::kRecentSwayS`), since a person stands still: see `SwayWatch` for how stepping on is left out. It ends when the load changes or
/// the centre of pressure is missing for more than 50 ms, and begins again at Go of a trial and when a session begins. A trial's window
/// continues after such a gap, without the missing samples, and after an undone redo or reject, with the samples in between. A new segment
/// ends every window without a last event.
/// Events name the scans that their values describe, corrected for the input's delay and the filter's own 80 ms; so a window's last event
/// is 80 ms after its end.
class Steadiness final : public Stage {
 public:
  Steadiness(const StageOptions& options, const StageContext& context);

  [[nodiscard]] static const StageDescription& description();
  [[nodiscard]] const StageDescription& describe() const noexcept override { return description(); }
  [[nodiscard]] core::Result<core::StreamFormat> prepare(const core::StreamFormat& input, std::size_t max_scans) override;
  void process(const core::Block& in, core::Block& out) noexcept override;
  void tell(core::FrameEvents& events) noexcept override;
  void reset() noexcept override;
  [[nodiscard]] std::size_t state_size() const noexcept override;
  [[nodiscard]] std::size_t state_added_since_0_1() const noexcept override { return watch_.state_added_since_0_1(); }
  void save(std::span<double> state) const noexcept override;
  [[nodiscard]] bool restore(std::span<const double> state) noexcept override;

 private:
  void forget() noexcept;
  void update_window(std::uint32_t segment) noexcept;
  [[nodiscard]] SwayWatch::Trial trial_in(std::uint32_t segment) const noexcept;
  [[nodiscard]] std::uint64_t index_of(core::ScanIndex scan) const noexcept;
  [[nodiscard]] core::ScanIndex scan_of(std::uint64_t index) const noexcept;
  void translate(core::SwayEvent& event, const core::Block& in) const noexcept;

  SteadinessWindows* windows_;
  std::optional<core::Rate> given_rate_;
  double every_ms_;
  double settle_ms_;
  core::Rate raw_rate_;
  std::uint64_t raw_per_scan_ = 1;
  std::uint64_t delay_scans_ = 0;  ///< In scans of the raw stream.
  std::uint64_t letter_ = 0;       ///< Number of the window read last.
  SteadinessWindow window_;        ///< The known window of a trial.
  std::uint32_t segment_ = 0;      ///< Current segment of `watch_`.
  SwayWatch watch_;
  SwayWatch::Events events_;  ///< Of the last block.
};

}  // namespace dts::pipeline
