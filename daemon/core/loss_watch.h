// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dts::core {

/// The newest scan of an arrival: when it was due, and how late it was.
struct Arrival {
  double time_s = 0.0;   ///< Nominal time of the scan since scan 0.
  double late_ns = 0.0;  ///< Arrival minus nominal time, relative to the first arrival of the segment.
};

/// Finds scans that went missing between the device and the host where no counter tells of them. The host counts on as if nothing had
/// happened, so from then on every scan seems to come late by as much as was lost, while a busy host is late only now and then:
///
///     late by |    .         .        . .    .  .    arrivals
///             |  .    .  .       .     .   .     .
///             |                     . ________.____
///             |____.________.____.___|               the least lateness rises, and stays
///                                    ^ scans lost here
///
/// Keeps the least late arrival of every quarter second and compares those of the last `kRecentSeconds` with those of the ten seconds
/// before. A slow clock is late, too: a rise that the slowest clock in question explains is not counted. On a busy host even the least
/// lateness of a quarter second scatters: the more it does, the larger a rise must be to be believed. Thread: one. Realtime-safe: yes.
class LossWatch {
 public:
  static constexpr double kRecentSeconds = 2.25;

  void restart() noexcept { *this = {}; }
  /// `steepest`: how fast the lateness may grow without a loss, seconds per second. Arrivals must not go back in time.
  void add(const Arrival& arrival, double steepest) noexcept;
  /// By how much the least lateness has risen, ns; 0 in the first seconds and while it falls.
  [[nodiscard]] std::int64_t rise_ns() const noexcept { return rise_ns_; }
  /// What chance alone may raise it by on this host, ns.
  [[nodiscard]] std::int64_t chance_ns() const noexcept { return chance_ns_; }
  /// Arrivals have been compared with earlier ones in this segment: before that nothing is known.
  [[nodiscard]] bool has_compared() const noexcept { return has_compared_; }

 private:
  static constexpr double kBinSeconds = 0.25;
  static constexpr std::size_t kBins = 50;        // 2.5 s and ten seconds
  static constexpr std::size_t kLeastRecent = 3;  // at low rates a bin holds one arrival
  void close_bin() noexcept;
  void compare(double now_s, double steepest) noexcept;

  std::array<Arrival, kBins> bins_{};  ///< Oldest first.
  std::size_t bin_count_ = 0;
  Arrival bin_;  ///< The least late arrival of the quarter second that runs.
  double bin_end_s_ = 0.0;
  bool has_bin_ = false;
  bool has_compared_ = false;
  std::int64_t rise_ns_ = 0;
  std::int64_t chance_ns_ = 0;
};

}  // namespace dts::core
