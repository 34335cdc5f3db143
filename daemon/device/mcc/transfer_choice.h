// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "device/usb/daq_driver.h"

namespace dts::device::mcc {

/// A stream of 16 bit codes over packets of a known size.
struct StreamLoad {
  double scan_hz = 0.0;
  std::size_t channels = 0;
  std::size_t packet_bytes = 64;  ///< wMaxPacketSize.
};

/// How scans travel. Immediate: a short packet after each scan (or few), one packet per transfer. Block: full packets only.
struct TransferChoice {
  bool is_immediate = false;
  std::size_t transfer_bytes = 0;
  std::size_t transfer_count = 0;
  std::int64_t transfer_period_ns = 0;  ///< Between the ends of two transfers.
};

/// Immediate only where it is needed and can be kept up: filling a packet takes longer than the request's latency, the rate is at
/// most 1000 Hz and the last scan did not overrun with it. Block transfers take about 10 ms, less when the latency asks for it, never
/// less than a packet. Enough transfers for half a second without the host.
[[nodiscard]] TransferChoice choose_transfers(const StreamLoad& load, const usb::ScanRequest& request);

/// One short packet per transfer, `packet_hz` of them per second.
[[nodiscard]] TransferChoice immediate_transfers(std::size_t packet_bytes, double packet_hz);
/// Full packets only.
[[nodiscard]] TransferChoice block_transfers(const StreamLoad& load, std::int64_t latency_ns);

/// The plan of a scan that travels so.
[[nodiscard]] usb::ScanPlan plan_of(const TransferChoice& choice, std::uint8_t endpoint);

}  // namespace dts::device::mcc
