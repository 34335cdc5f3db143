// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/rate.h"

namespace dts::device::labjack {

inline constexpr double kMaximumSamplesPerSecond = 50'000.0;  ///< All channels together (U6 data sheet, section 3.2).
inline constexpr double kMinimumRateHz = 15'625.0 / 65'535.0;
inline constexpr std::size_t kMaximumSamplesPerPacket = 25;

/// Whole scans are timed by a clock divided by 1 to 65535; samples within a scan follow as fast as they can.
struct ScanClock {
  std::uint8_t scan_config = 0;
  std::uint16_t interval = 1;
  core::Rate rate;  ///< Exactly.
};

/// The setting nearest to `wanted`, from the fastest clock that is slow enough, so that the steps are finest. Every full speed
/// of 50000/channels is exact, so that no rate below it is rounded beyond it.
[[nodiscard]] ScanClock nearest_clock(core::Rate wanted) noexcept;

/// How samples travel.
struct Packing {
  std::size_t samples_per_packet = kMaximumSamplesPerPacket;
  std::size_t packets_per_transfer = 1;
  std::int64_t transfer_period_ns = 0;
};

/// A packet of 25 samples has exactly the 64 bytes of a USB packet, so that one transfer takes several; a smaller one ends its
/// transfer. So: while 25 samples take longer than `latency_ns`, packets of as many whole scans as fit into it; else as many
/// packets of 25 as fit.
[[nodiscard]] Packing pack(core::Rate rate, std::size_t channels, std::int64_t latency_ns, bool must_use_large_packets) noexcept;

}  // namespace dts::device::labjack
