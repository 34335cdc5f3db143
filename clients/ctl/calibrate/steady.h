// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace dts::ctl {

/// What may still be called steady, in the unit of the channels.
struct SteadyLimits {
  std::size_t window_scans = 8;  ///< The hold that is averaged: at least kLeastWindowScans.
  double drift = 0.01;           ///< Beyond what noise explains.
  double noise = 0.1;            ///< Rms of single scans: more is no rest.
};

inline constexpr std::size_t kLeastWindowScans = 8;

/// The mean of a steady hold, per channel.
struct SteadyReading {
  std::vector<double> mean;
  std::vector<double> noise;  ///< Rms of single scans about their quarter's mean; median of the quarters.
  std::size_t scans = 0;
};

/// Decides when several channels rest. The last `window_scans` scans are cut into four quarters, with a lead-in of one more quarter before
/// them. At rest the means of all five differ by noise only,
///
///     max(means) - min(means) <= drift + 4 * noise / sqrt(scans per independent quarter),
///
///     ...moving... | lead-in | 1 | 2 | 3 | 4 | now        the mean is that of 1 to 4
///
/// The lead-in takes up the end of the movement: without it the first window that passes always holds as much of it as the limits
/// let through, and every reading errs to the same side (measured: 2 mV behind a limit of 5 mV).
///
/// where the noise is the median of the quarters' own, so that neither a drift nor the last moment of putting down can excuse itself. The
/// daemon's window filter makes three neighbouring scans dependent: a quarter counts as a third of its scans.
class SteadyDetector {
 public:
  SteadyDetector(std::size_t channel_count, const SteadyLimits& limits);

  /// Scans that must rest before there is a reading.
  [[nodiscard]] std::size_t ring_scans() const noexcept { return limits_.window_scans + limits_.window_scans / 4; }
  /// One scan; a value that is not finite begins anew.
  void add(std::span<const double> scan);
  /// Begins anew: what was seen belongs to something else.
  void reset() noexcept;
  [[nodiscard]] bool is_full() const noexcept { return count_ >= ring_scans(); }
  /// The reading when the window is full and every channel rests.
  [[nodiscard]] std::optional<SteadyReading> reading() const;
  /// Which channel moves most, and how: "drifts by 0.123"; empty while the window is not full or all rest.
  struct Unrest {
    std::size_t channel = 0;
    std::string text;
  };
  [[nodiscard]] std::optional<Unrest> unrest() const;

 private:
  struct Judgement {
    double mean = 0.0;
    double noise = 0.0;
    double drift = 0.0;  ///< Between the quarters.
    double drift_limit = 0.0;
  };
  [[nodiscard]] Judgement judge(std::size_t channel) const;
  [[nodiscard]] bool rests(const Judgement& judgement) const noexcept {
    return judgement.noise <= limits_.noise && judgement.drift <= judgement.drift_limit;
  }

  SteadyLimits limits_;
  std::vector<std::vector<double>> ring_;  ///< Per channel.
  std::size_t count_ = 0;                  ///< Scans since the beginning.
};

}  // namespace dts::ctl
