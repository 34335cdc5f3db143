// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/rate.h"
#include "usb/emulator/emulated_device.h"
#include "usb/emulator/faults.h"

namespace dts::emulator {

inline constexpr std::int64_t kNeverNs = std::numeric_limits<std::int64_t>::max();

/// A pacer: after each full period since its start it ticks once. Exact over days; the count goes on over stop and start, so
/// that another device can be clocked by it.
class ScanClock {
 public:
  /// `speed`: how much faster than `rate` it really runs (1 + 80e-6: 80 ppm fast).
  void start(core::Rate rate, double speed, std::int64_t now_ns) noexcept;
  void stop(std::int64_t now_ns) noexcept;

  [[nodiscard]] core::Rate rate() const noexcept { return rate_; }  ///< Nominal.
  /// Ticks up to and with `now_ns`, since ever.
  [[nodiscard]] std::uint64_t ticks(std::int64_t now_ns) const noexcept;
  /// When tick `number`, from 1, comes; kNeverNs: not by itself; some time in the past when it has been.
  [[nodiscard]] std::int64_t tick_ns(std::uint64_t number) const noexcept;
  /// Time of tick `number` by the device that ticks: its first tick after a start is 0 s. Known for the newest two starts.
  [[nodiscard]] double device_time_s(std::uint64_t number) const noexcept;

 private:
  core::Rate rate_;
  std::int64_t speed_e9_ = 1'000'000'000;
  std::int64_t start_ns_ = 0;
  std::uint64_t before_ = 0;         ///< Ticks of earlier starts.
  std::uint64_t newest_start_ = 0;   ///< Ticks before the newest start ...
  std::uint64_t earlier_start_ = 0;  ///< ... and before the one before.
  bool is_running_ = false;
};

/// What a scan converts.
struct FeedSetup {
  core::Rate rate;                  ///< Ticks per second, as the device's registers say.
  std::vector<std::size_t> inputs;  ///< Input of each position of the scan.
  std::size_t codes_per_tick = 0;   ///< Scan length: a tick takes a whole scan. 1: a tick takes the next position only.
  double skew_s = 0.0;              ///< Between two conversions of one tick.
  std::size_t fifo_codes = 0;       ///< More than this waiting is an overrun; 0: unlimited.
  std::uint64_t last_code = 0;      ///< The scan ends after so many codes; 0: never.
};

/// Voltage at a position of the scan as the converter's code.
using Converter = std::function<std::uint16_t(std::size_t position, double volts)>;

/// The converter and its FIFO: how many codes wait at a time, and which. Codes are computed when they are taken, from their
/// number alone. By its own clock the first scan
/// has device time 0; at another's ticks, the time of that device: whoever starts late converts what stands there then. Here strike
/// drop_code_at, corrupt_at_code, silence_at_code, clock_error_ppm and rate_factor; codes are counted as they were taken by the converter,
/// missing ones included.
class SampleFeed {
 public:
  /// `source` fills `input_count` voltages.
  SampleFeed(Source source, std::size_t input_count) : source_(std::move(source)), volts_(input_count) {}

  /// Scans from now on by its own clock.
  void start(FeedSetup setup, Converter converter, Faults& faults, std::int64_t now_ns);
  /// Scans at each tick of another clock from now on; `setup.rate` is not used. `clock` outlives the scan.
  void start(FeedSetup setup, Converter converter, Faults& faults, const ScanClock& clock, std::int64_t now_ns);
  void stop(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_running() const noexcept { return clock_ != nullptr; }

  /// Codes that can be taken.
  [[nodiscard]] std::uint64_t available(std::int64_t now_ns) const noexcept;
  [[nodiscard]] bool is_over_limit(std::int64_t now_ns) const noexcept;
  /// When at least `count` codes can be taken, nothing being taken until then; kNeverNs: not by itself.
  [[nodiscard]] std::int64_t ready_ns(std::uint64_t count) const noexcept;
  /// The next code; `available` must not be 0.
  [[nodiscard]] std::uint16_t take();
  /// Number of the code that `take` would give, from 0 at the start.
  [[nodiscard]] std::uint64_t position() const noexcept { return next_; }
  /// Throws away the next `count` codes: lost in the device.
  void skip(std::uint64_t count) noexcept { next_ += count; }
  /// The next `count` codes are the last of a scan that has an end.
  [[nodiscard]] bool is_last(std::uint64_t count) const noexcept { return setup_.last_code != 0 && next_ + count >= setup_.last_code; }
  /// `count`, or as many as the scan still has.
  [[nodiscard]] std::uint64_t remaining(std::uint64_t count) const noexcept;
  /// Device time of the first tick after `now_ns`; 0 when no scan runs.
  [[nodiscard]] double next_tick_s(std::int64_t now_ns) const noexcept;

  /// For single readings: the voltages at the inputs at device time `time_s`.
  [[nodiscard]] const std::vector<double>& look(double time_s);

 private:
  void begin(FeedSetup setup, Converter converter, Faults& faults);
  [[nodiscard]] std::uint64_t taken(std::int64_t now_ns) const noexcept;  ///< By the converter.
  [[nodiscard]] bool drops_within(std::uint64_t end) const noexcept {
    return faults_->drop_code_at >= next_ && faults_->drop_code_at < end;
  }

  Source source_;
  std::vector<double> volts_;
  double evaluated_s_ = -1.0;  ///< Device time of `volts_`.
  FeedSetup setup_;
  Converter converter_;
  Faults* faults_ = nullptr;
  ScanClock own_clock_;
  const ScanClock* clock_ = nullptr;  ///< nullptr: not scanning.
  std::uint64_t first_tick_ = 0;      ///< Ticks of the clock before this scan.
  std::uint64_t next_ = 0;
};

}  // namespace dts::emulator
