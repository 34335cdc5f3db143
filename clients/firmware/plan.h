// SPDX-License-Identifier: Apache-2.0
// Which rate a board can run, and how many scans it puts into a frame. Computed from the speed of the line and of the converter.
#pragma once

#include <stdint.h>

#include "firmware/frame.h"

namespace firmware {

/// What a board and its line can do. Periods are in ticks of the board's clock.
struct Limits {
  uint8_t channels;
  uint32_t ticks_per_second;
  uint16_t shortest_period;  ///< That of the timer and the converter.
  uint16_t longest_period;
  uint32_t bytes_per_second;  ///< Of the line; 0: the line is not the limit.
};

constexpr uint8_t kScansHeader = 11;           // type, run, counter, ticks, n
constexpr uint8_t kLargestScansPayload = 180;  // a frame fits into the ring while the tail of the one before is still there
constexpr uint8_t kMostScans = 20;

constexpr uint8_t scans_payload(uint8_t channels, uint8_t scans) { return static_cast<uint8_t>(kScansHeader + 2 * channels * scans); }

/// Returns how many scans fit into the largest frame.
constexpr uint8_t most_scans(uint8_t channels) {
  const int fitting = (kLargestScansPayload - kScansHeader) / (2 * channels);
  return static_cast<uint8_t>(fitting < kMostScans ? fitting : kMostScans);
}

/// Returns the shortest period at which frames take 92 % of the line at most. The rest is for descriptors and for the error of the baud
/// rate.
constexpr uint16_t shortest_period(const Limits& limits) {
  if (limits.bytes_per_second == 0) return limits.shortest_period;
  const uint32_t scans = most_scans(limits.channels);
  const uint32_t frame = FrameWriter::size_on_wire(scans_payload(limits.channels, most_scans(limits.channels)));
  const uint32_t per_second = limits.bytes_per_second * 92 / 100 * scans / frame;
  const uint32_t period = (limits.ticks_per_second + per_second - 1) / per_second;
  return period > limits.shortest_period ? static_cast<uint16_t>(period) : limits.shortest_period;
}

/// Returns the period that is next to the wanted rate, within what the board can do. `numerator` and `denominator` are not 0.
inline uint16_t period_for(const Limits& limits, uint32_t numerator, uint32_t denominator) {
  const uint64_t ticks = static_cast<uint64_t>(limits.ticks_per_second) * denominator;
  const uint64_t period = (ticks + numerator / 2) / numerator;
  if (period < shortest_period(limits)) return shortest_period(limits);
  return period > limits.longest_period ? limits.longest_period : static_cast<uint16_t>(period);
}

/// Returns how many scans a frame has: as many as fit, but the first one waits for 40 ms at most.
constexpr uint8_t scans_per_frame(const Limits& limits, uint16_t period) {
  const uint32_t in_time = limits.ticks_per_second / 25 / period + 1;
  return in_time < most_scans(limits.channels) ? static_cast<uint8_t>(in_time) : most_scans(limits.channels);
}

}  // namespace firmware
