// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dts::core {

/// The newest scan of an arrival: its nominal time, and how late it arrived.
struct Arrival {
  double time_s = 0.0;   ///< Nominal time from scan 0 to the scan.
  double late_ns = 0.0;  ///< Arrival minus nominal time, relative to the first arrival of the segment.
};

/// Finds scans that were lost between the device and the host if no counter shows the loss. The host does not notice the loss and keeps
/// counting, so every later scan seems to arrive late by the lost time. A busy host is late only sometimes:
///
///     late by |    .         .        . .    .  .    arrivals
///             |  .    .  .       .     .   .     .
///             |                     . ________.____
///             |____.________.____.___|               the least lateness rises and stays high
///                                    ^ scans lost here
///
/// Keeps the least late arrival of every quarter second, and compares the last `kRecentSeconds` with the ten seconds before. A slow clock
/// also makes scans late: a rise that the slowest possible clock explains does not count. On a busy host even the least lateness of a
/// quarter second scatters: the larger the scatter, the larger must be the rise.
///
/// A slow clock makes every quarter second later than the one before, lost scans only some of them. So the median of these steps is the
/// drift of a clock that may be far off. Thread: one. Realtime-safe: yes.
class LossWatch {
 public:
  static constexpr double kRecentSeconds = 2.25;

  void restart() noexcept { *this = {}; }
  /// Adds an arrival. How fast the lateness may grow without a loss, seconds per second: `steepest`, or, if it grows steadily, up to
  /// `steepest_steady`, which is not less. Times must not decrease.
  void add(const Arrival& arrival, double steepest, double steepest_steady) noexcept;
  /// Returns how much the least lateness has risen, ns; 0 in the first seconds and while it falls.
  [[nodiscard]] std::int64_t rise_ns() const noexcept { return rise_ns_; }
  /// Returns the rise that scatter alone can cause on this host, ns.
  [[nodiscard]] std::int64_t chance_ns() const noexcept { return chance_ns_; }
  /// Returns true if arrivals of this segment have been compared with earlier ones; before that `rise_ns` is always 0.
  [[nodiscard]] bool has_compared() const noexcept { return has_compared_; }

 private:
  static constexpr double kBinSeconds = 0.25;
  static constexpr std::size_t kBins = 50;        // 2.5 s + 10 s
  static constexpr std::size_t kLeastRecent = 3;  // at low rates a bin holds one arrival
  void close_bin() noexcept;
  void compare(double now_s, double slope) noexcept;
  [[nodiscard]] double median_slope() const noexcept;

  std::array<Arrival, kBins> bins_{};  ///< Oldest first.
  std::size_t bin_count_ = 0;
  Arrival bin_;  ///< The least late arrival of the current quarter second.
  double bin_end_s_ = 0.0;
  bool has_bin_ = false;
  bool has_compared_ = false;
  std::int64_t rise_ns_ = 0;
  std::int64_t chance_ns_ = 0;
};

}  // namespace dts::core
