// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "core/block.h"
#include "core/latest_value.h"

namespace dts::pipeline {

enum class TareOutcome : std::uint8_t {
  None,       ///< Never asked for.
  Running,    ///< Averaging.
  Done,       ///< `baseline_mm` is in use.
  Loaded,     ///< Refused: a sensor is further from its nominal unloaded gap than the limit. Somebody is on the plate.
  Unsteady,   ///< Refused: the plate moved while averaging.
  BadSensor,  ///< Refused: a sensor has a quality fault.
};

struct TareReport {
  std::uint64_t request = 0;  ///< Number of the request this answers.
  TareOutcome outcome = TareOutcome::None;
  bool is_older_in_use = false;  ///< Refused or withdrawn: `baseline_mm` stays that of before.
  std::size_t channel_count = 0;
  std::array<double, core::kMaxChannels> baseline_mm{};  ///< Deflection taken as zero from now on, per sensor.
};

/// The letter box between whoever asks for a tare and the stage that does it.
class Tare {
 public:
  /// Asks for a new baseline; returns the request's number. Thread: control. Realtime-safe: yes.
  std::uint64_t request() noexcept { return requested_.fetch_add(1, std::memory_order_acq_rel) + 1; }
  /// Withdraws a request nobody waits for any more: an average that is still running for it changes nothing.
  /// Thread: control. Realtime-safe: yes.
  void cancel(std::uint64_t request) noexcept { cancelled_.store(request, std::memory_order_release); }  // pairs with is_cancelled()
  /// The newest report. Thread: control (the one reader).
  [[nodiscard]] const TareReport& latest() noexcept { return report_.load(); }

  /// Number of the newest request; 0 when there was none. Thread: pipeline. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t requested() const noexcept { return requested_.load(std::memory_order_acquire); }  // pairs with request()
  /// Thread: pipeline. Realtime-safe: yes.
  [[nodiscard]] bool is_cancelled(std::uint64_t request) const noexcept {
    return request != 0 && cancelled_.load(std::memory_order_acquire) == request;  // pairs with cancel()
  }
  /// Thread: pipeline (the one writer). Realtime-safe: yes.
  void report(const TareReport& report) noexcept { report_.store(report); }

 private:
  std::atomic<std::uint64_t> requested_{0};
  std::atomic<std::uint64_t> cancelled_{0};
  core::LatestValue<TareReport> report_;
};

}  // namespace dts::pipeline
