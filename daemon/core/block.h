// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/rate.h"
#include "core/units.h"

namespace dts::core {

inline constexpr std::size_t kMaxChannels = 32;
inline constexpr std::size_t kMaxBlockScans = 4096;

/// Doubts about one value, as bits. 0 is a good value. A value that cannot be computed is NaN and has a bit saying why.
namespace quality {
inline constexpr std::uint8_t kRail = 1U << 0;          ///< At or next to the end of the converter's range.
inline constexpr std::uint8_t kStuck = 1U << 1;         ///< Has not changed by one code for too long.
inline constexpr std::uint8_t kOutOfRange = 1U << 2;    ///< Outside the sensor's working range or calibrated curve.
inline constexpr std::uint8_t kRotation = 1U << 3;      ///< The marker channel is wrong: channels may be rotated.
inline constexpr std::uint8_t kNoContact = 1U << 4;     ///< Nobody on the plate: there is no centre of pressure.
inline constexpr std::uint8_t kUncalibrated = 1U << 5;  ///< Outside the area or load range of the calibration.
inline constexpr std::uint8_t kUntared = 1U << 6;       ///< No tare yet: the nominal unloaded gap is the baseline.
inline constexpr std::uint8_t kSubstituted = 1U << 7;   ///< A bad sensor was replaced by the change of the others.
}  // namespace quality

struct ChannelFormat {
  std::string name;  ///< "w1_v", "ml_mm"
  std::string unit;  ///< "V", "mm", "N"

  friend bool operator==(const ChannelFormat&, const ChannelFormat&) = default;
};

/// What is constant about a stream while the daemon runs.
struct StreamFormat {
  std::string name;  ///< "raw", "filtered", "deflection", "cop", ...
  Rate rate;
  std::vector<ChannelFormat> channels;
  std::int64_t delay_ns = 0;  ///< A value describes the input this long before its scan (group delay of the filters).
};

/// Consecutive scans of one stream, columns by channel. Memory is taken at construction only; a default-constructed block
/// holds nothing and is a placeholder.
class Block {
 public:
  Block() = default;
  Block(std::size_t channel_count, std::size_t capacity_scans)
      : channels_(channel_count),
        capacity_(capacity_scans),
        values_(channel_count * capacity_scans),
        quality_(channel_count * capacity_scans) {}

  std::uint32_t segment = 0;                  ///< Counts up at every gap; scan indices restart.
  ScanIndex first_scan;                       ///< Of this segment.
  std::int64_t host_time_ns = 0;              ///< Monotonic host time of the first scan's instant.
  std::int64_t host_time_uncertainty_ns = 0;  ///< How far that may be off.
  double clock_drift_ppm = 0.0;               ///< How much faster than nominal the device's clock runs, as far as known.
  std::uint64_t sequence = 0;                 ///< Counts the blocks of this stream, so that a lost one shows.

  [[nodiscard]] std::size_t channel_count() const noexcept { return channels_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// At most `capacity()`: a larger count is cut, so that no column reaches beyond its memory. Columns keep what they hold.
  void set_count(std::size_t scans) noexcept { count_ = std::min(scans, capacity_); }

  /// Values of a channel; `channel` must be below `channel_count()`.
  [[nodiscard]] std::span<double> column(std::size_t channel) noexcept { return {values_.data() + channel * capacity_, count_}; }
  [[nodiscard]] std::span<const double> column(std::size_t channel) const noexcept {
    return {values_.data() + channel * capacity_, count_};
  }
  /// Quality bits of each value of a channel.
  [[nodiscard]] std::span<std::uint8_t> quality(std::size_t channel) noexcept { return {quality_.data() + channel * capacity_, count_}; }
  [[nodiscard]] std::span<const std::uint8_t> quality(std::size_t channel) const noexcept {
    return {quality_.data() + channel * capacity_, count_};
  }

  /// Takes segment, first scan, host time and count (at most `capacity()`) from `other`. Realtime-safe: yes.
  void copy_position(const Block& other) noexcept {
    segment = other.segment;
    first_scan = other.first_scan;
    host_time_ns = other.host_time_ns;
    host_time_uncertainty_ns = other.host_time_uncertainty_ns;
    clock_drift_ppm = other.clock_drift_ppm;
    set_count(other.count());
  }

  /// Takes everything that `other` says; of its channels and scans as many as there is room for. Realtime-safe: yes.
  void copy_from(const Block& other) noexcept {
    copy_position(other);
    sequence = other.sequence;
    for (std::size_t channel = 0; channel < std::min(channels_, other.channels_); ++channel) {
      std::ranges::copy(other.column(channel).first(count_), column(channel).begin());
      std::ranges::copy(other.quality(channel).first(count_), quality(channel).begin());
    }
  }

 private:
  std::size_t channels_ = 0;
  std::size_t capacity_ = 0;
  std::size_t count_ = 0;
  std::vector<double> values_;
  std::vector<std::uint8_t> quality_;
};

}  // namespace dts::core
