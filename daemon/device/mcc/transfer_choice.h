// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "device/usb/daq_driver.h"

namespace dts::device::mcc {

/// A stream of 16 bit codes in packets of a known size.
struct StreamLoad {
  double scan_hz = 0.0;
  std::size_t channels = 0;
  std::size_t packet_bytes = 64;  ///< wMaxPacketSize.
};

/// How scans are sent. Immediate: a short packet after one or a few scans, one packet per transfer. Block: full packets only.
struct TransferChoice {
  bool is_immediate = false;
  std::size_t transfer_bytes = 0;
  std::size_t transfer_count = 0;
  std::int64_t transfer_period_ns = 0;  ///< Time between the ends of two transfers.
};

/// Chooses immediate transfers only if they are needed and possible: a full packet takes longer than the requested latency, a scan is
/// shorter than a packet, the rate is at most 1000 Hz and the device has not overrun. Block transfers last about 10 ms, less for a smaller
/// latency, at least one packet. The transfers in flight last for about half a second without the host.
[[nodiscard]] TransferChoice choose_transfers(const StreamLoad& load, const usb::ScanRequest& request);

/// Returns immediate transfers: one short packet per transfer, `packet_hz` per second.
[[nodiscard]] TransferChoice immediate_transfers(std::size_t packet_bytes, double packet_hz);
/// Returns block transfers: full packets only.
[[nodiscard]] TransferChoice block_transfers(const StreamLoad& load, std::int64_t latency_ns);

/// Returns the plan of a scan with these transfers.
[[nodiscard]] usb::ScanPlan plan_of(const TransferChoice& choice, std::uint8_t endpoint);

}  // namespace dts::device::mcc
