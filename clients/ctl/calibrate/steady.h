// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dts::ctl {

/// Limits for a steady signal, in the unit of the channels.
struct SteadyLimits {
  std::size_t window_scans = 8;  ///< Scans of the hold that is averaged: at least kLeastWindowScans.
  double drift = 0.01;           ///< Largest drift in addition to noise.
  double noise = 0.1;            ///< Rms of single scans; above it the signal is not steady.
};

inline constexpr std::size_t kLeastWindowScans = 8;

/// The mean of a steady hold, per channel.
struct SteadyReading {
  std::vector<double> mean;
  std::vector<double> noise;  ///< Rms of single scans around their quarter's mean; median of the quarters.
  std::size_t scans = 0;
};

/// Decides when several channels are steady. The last `window_scans` scans are divided into four quarters, preceded by a lead-in of one
/// more quarter. If a channel is steady, the means of all five differ only by noise:
///
///     max(means) - min(means) <= drift + 4 * noise / sqrt(scans per independent quarter),
///
///     ...moving... | lead-in | 1 | 2 | 3 | 4 | now        the result is the mean of 1 to 4
///
/// The noise is the median of the quarters' own noise, so that neither a drift nor the end of the movement raises its own limit. The
/// daemon's window filter makes three neighbouring scans dependent: a quarter counts as a third of its scans.
///
/// The lead-in absorbs the end of the movement. Without it, the first window that passes would always contain as much movement as the
/// limits allow, and every reading would have an error in the same direction (measured: 2 mV with a limit of 5 mV).
class SteadyDetector {
 public:
  SteadyDetector(std::size_t channel_count, const SteadyLimits& limits);

  /// Returns the number of steady scans that a reading needs.
  [[nodiscard]] std::size_t ring_scans() const noexcept { return limits_.window_scans + limits_.window_scans / 4; }
  /// Adds one scan; a value that is not finite starts the window again.
  void add(std::span<const double> scan);
  /// Starts the window again: the scans so far are not part of the next hold.
  void reset() noexcept;
  [[nodiscard]] bool is_full() const noexcept { return count_ >= ring_scans(); }
  /// Returns the reading if the window is full and every channel is steady.
  [[nodiscard]] std::optional<SteadyReading> reading() const;
  /// The channel that moves most, and how: "drifts by 0.123"; absent while the window is not full or if all are steady.
  struct Unrest {
    std::size_t channel = 0;
    std::string text;
  };
  [[nodiscard]] std::optional<Unrest> unrest() const;

 private:
  struct Estimate {
    double mean = 0.0;
    double noise = 0.0;
    double drift = 0.0;  ///< Range of the means of lead-in and quarters.
    double drift_limit = 0.0;
  };
  [[nodiscard]] Estimate estimate_of(std::size_t channel) const;
  [[nodiscard]] bool rests(const Estimate& estimate) const noexcept {
    return estimate.noise <= limits_.noise && estimate.drift <= estimate.drift_limit;
  }

  SteadyLimits limits_;
  std::vector<std::vector<double>> ring_;  ///< Per channel.
  std::size_t count_ = 0;                  ///< Scans since the start of the window.
};

}  // namespace dts::ctl
