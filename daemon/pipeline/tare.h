// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "core/block.h"
#include "core/latest_value.h"

namespace dts::pipeline {

enum class TareOutcome : std::uint8_t {
  None,       ///< No tare was requested, or it was cancelled.
  Running,    ///< Averaging.
  Done,       ///< `baseline` is in use.
  Loaded,     ///< Rejected: there is a load on the plate; the stage's limit says from what on.
  Unsteady,   ///< Rejected: the plate moved while averaging.
  BadSensor,  ///< Rejected: a sensor has a quality fault.
};

/// The unit in which a stage has its zero.
enum class ZeroUnit : std::uint8_t {
  Millimetres,  ///< Of deflection.
  Volts,        ///< Of the channels of a force plate.
};

struct TareReport {
  std::uint64_t request = 0;  ///< Number of the request that this report answers.
  TareOutcome outcome = TareOutcome::None;
  bool is_older_in_use = false;  ///< The tare was rejected or cancelled, and the earlier `baseline` stays in use.
  std::size_t channel_count = 0;
  ZeroUnit unit = ZeroUnit::Millimetres;
  std::array<double, core::kMaxChannels> baseline{};  ///< The zero in use, by channel, in `unit`.
  /// How fast the vertical force on the empty plate changes, N/min; absent: not known yet, or not a force plate.
  std::optional<double> drift_n_per_min{};
};

/// Passes tare requests from the control thread to the stage that executes them, and reports back.
class Tare {
 public:
  /// Requests a new baseline; returns the request's number. Thread: control. Realtime-safe: yes.
  std::uint64_t request() noexcept { return requested_.fetch_add(1, std::memory_order_acq_rel) + 1; }
  /// Cancels a request whose client no longer waits: its average, if still running, will not be used.
  /// Thread: control. Realtime-safe: yes.
  void cancel(std::uint64_t request) noexcept { cancelled_.store(request, std::memory_order_release); }  // pairs with is_cancelled()
  /// Returns the newest report. Thread: control (the one reader).
  [[nodiscard]] const TareReport& latest() noexcept { return report_.load(); }

  /// Returns the number of the newest request; 0: none yet. Thread: rig. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t requested() const noexcept { return requested_.load(std::memory_order_acquire); }  // pairs with request()
  /// Thread: rig. Realtime-safe: yes.
  [[nodiscard]] bool is_cancelled(std::uint64_t request) const noexcept {
    return request != 0 && cancelled_.load(std::memory_order_acquire) == request;  // pairs with cancel()
  }
  /// Thread: rig (the one writer). Realtime-safe: yes.
  void report(const TareReport& report) noexcept { report_.store(report); }

 private:
  std::atomic<std::uint64_t> requested_{0};
  std::atomic<std::uint64_t> cancelled_{0};
  core::LatestValue<TareReport> report_;
};

}  // namespace dts::pipeline
