// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/rate.h"

namespace dts::device::labjack {

inline constexpr double kMaximumSamplesPerSecond = 50'000.0;  ///< Limit for all channels together (U6 data sheet, section 3.2).
inline constexpr double kMinimumRateHz = 15'625.0 / 65'535.0;
inline constexpr std::size_t kMaximumSamplesPerPacket = 25;

/// A clock divided by 1 to 65535 starts the scans; samples within a scan follow as fast as possible.
struct ScanClock {
  std::uint8_t scan_config = 0;
  std::uint16_t interval = 1;
  core::Rate rate;  ///< Exact rate.
};

/// Returns the setting nearest to `wanted`, with the fastest clock that can run so slowly: it has the finest steps. The highest rate
/// of 50000/channels is exact, so no lower rate is rounded to a higher rate than that.
[[nodiscard]] ScanClock nearest_clock(core::Rate wanted) noexcept;

/// Sizes of packets and transfers.
struct Packing {
  std::size_t samples_per_packet = kMaximumSamplesPerPacket;
  std::size_t packets_per_transfer = 1;
  std::int64_t transfer_period_ns = 0;
};

/// Chooses packets and transfers. A packet of 25 samples has exactly the 64 bytes of a USB packet, so one transfer can hold several; a
/// smaller packet ends its transfer. If 25 samples take longer than `latency_ns`, a transfer has one packet with as many whole scans as
/// `latency_ns` allows; otherwise it has as many packets of 25 samples as `latency_ns` allows.
[[nodiscard]] Packing pack(core::Rate rate, std::size_t channels, std::int64_t latency_ns, bool must_use_large_packets) noexcept;

}  // namespace dts::device::labjack
