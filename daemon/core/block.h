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

/// Doubts about one value, as bits. 0: a good value. A value that cannot be computed is NaN, and a bit shows the reason.
namespace quality {
inline constexpr std::uint8_t kRail = 1U << 0;          ///< At the end of the converter's range, or next to it.
inline constexpr std::uint8_t kStuck = 1U << 1;         ///< The value has not changed by even one code for too long.
inline constexpr std::uint8_t kOutOfRange = 1U << 2;    ///< Outside the sensor's working range, curve or travel.
inline constexpr std::uint8_t kRotation = 1U << 3;      ///< The marker channel is wrong: channels may be rotated.
inline constexpr std::uint8_t kNoContact = 1U << 4;     ///< No person on the plate: no centre of pressure.
inline constexpr std::uint8_t kUncalibrated = 1U << 5;  ///< Outside the area or load range of the calibration.
inline constexpr std::uint8_t kUntared = 1U << 6;       ///< No tare yet, or the zero has drifted too far since.
inline constexpr std::uint8_t kSubstituted = 1U << 7;   ///< The value of a bad sensor was estimated from the change of the others.
}  // namespace quality

struct ChannelFormat {
  std::string name;  ///< "w1_v", "ml_mm"
  std::string unit;  ///< "V", "mm", "N"

  friend bool operator==(const ChannelFormat&, const ChannelFormat&) = default;
};

/// Properties of a stream that stay constant while the daemon runs.
struct StreamFormat {
  std::string name;  ///< "raw", "filtered", "deflection", "cop", ...
  Rate rate;
  std::vector<ChannelFormat> channels;
  std::int64_t delay_ns = 0;  ///< Group delay of the filters: a value belongs to the input this long before its scan.
};

/// Consecutive scans of one stream, one column per channel. Only the constructor allocates; a default-constructed block is an
/// empty placeholder.
class Block {
 public:
  Block() = default;
  Block(std::size_t channel_count, std::size_t capacity_scans)
      : channels_(channel_count),
        capacity_(capacity_scans),
        values_(channel_count * capacity_scans),
        quality_(channel_count * capacity_scans) {}

  std::uint32_t segment = 0;                  ///< Increases at every gap; scan indices restart then.
  ScanIndex first_scan;                       ///< Index of the first scan in this segment.
  std::int64_t host_time_ns = 0;              ///< Monotonic host time at which the first scan was sampled.
  std::int64_t host_time_uncertainty_ns = 0;  ///< Possible error of `host_time_ns`.
  double clock_drift_ppm = 0.0;               ///< How much faster than nominal the device's clock runs; 0 while unknown.
  std::uint64_t sequence = 0;                 ///< Number of this block in its stream: a missing number shows a lost block.

  [[nodiscard]] std::size_t channel_count() const noexcept { return channels_; }
  [[nodiscard]] std::size_t capacity() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Sets the count, limited to `capacity()` so that no column exceeds its memory. Does not change the values.
  void set_count(std::size_t scans) noexcept { count_ = std::min(scans, capacity_); }

  /// Returns the values of a channel; `channel` must be below `channel_count()`.
  [[nodiscard]] std::span<double> column(std::size_t channel) noexcept { return {values_.data() + channel * capacity_, count_}; }
  [[nodiscard]] std::span<const double> column(std::size_t channel) const noexcept {
    return {values_.data() + channel * capacity_, count_};
  }
  /// Returns the quality bits of a channel, one byte per value.
  [[nodiscard]] std::span<std::uint8_t> quality(std::size_t channel) noexcept { return {quality_.data() + channel * capacity_, count_}; }
  [[nodiscard]] std::span<const std::uint8_t> quality(std::size_t channel) const noexcept {
    return {quality_.data() + channel * capacity_, count_};
  }

  /// Copies segment, first scan, host time, drift and count (at most `capacity()`) from `other`. Realtime-safe: yes.
  void copy_position(const Block& other) noexcept {
    segment = other.segment;
    first_scan = other.first_scan;
    host_time_ns = other.host_time_ns;
    host_time_uncertainty_ns = other.host_time_uncertainty_ns;
    clock_drift_ppm = other.clock_drift_ppm;
    set_count(other.count());
  }

 private:
  std::size_t channels_ = 0;
  std::size_t capacity_ = 0;
  std::size_t count_ = 0;
  std::vector<double> values_;
  std::vector<std::uint8_t> quality_;
};

}  // namespace dts::core
