// SPDX-License-Identifier: Apache-2.0
#include "device/mcc/transfer_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/clock.h"
#include "device/mcc/control.h"

namespace dts::device::mcc {
namespace {

constexpr double kBlockNs = 10e6;                      // as uldaq: transfers of 10 ms
constexpr double kHeadroomNs = 500e6;                  // the host may be blocked for this long
constexpr double kLargestImmediateHz = 1000.0;         // as uldaq; at higher rates one transfer per scan costs too much
constexpr std::size_t kLargestTransferBytes = 16'384;  // usbfs splits larger ones
constexpr std::size_t kFewestTransfers = 8;
constexpr std::size_t kMostTransfers = 512;
constexpr std::size_t kBufferSeconds = 4;

/// Returns the time in which a packet fills.
double packet_ns(const StreamLoad& load) {
  const double bytes_per_second = static_cast<double>(kCodeBytes * load.channels) * load.scan_hz;
  return static_cast<double>(load.packet_bytes) / bytes_per_second * core::kNanosecondsPerSecond;
}

std::size_t count_for(double period_ns) {
  return std::clamp(static_cast<std::size_t>(std::ceil(kHeadroomNs / period_ns)), kFewestTransfers, kMostTransfers);
}

}  // namespace

TransferChoice immediate_transfers(std::size_t packet_bytes, double packet_hz) {
  const double period_ns = core::kNanosecondsPerSecond / packet_hz;
  return {.is_immediate = true,
          .transfer_bytes = packet_bytes,
          .transfer_count = count_for(period_ns),
          .transfer_period_ns = std::llround(period_ns)};
}

TransferChoice block_transfers(const StreamLoad& load, std::int64_t latency_ns) {
  const double longest_ns = std::min(kBlockNs, static_cast<double>(latency_ns));
  const auto most_packets = static_cast<double>(kLargestTransferBytes / load.packet_bytes);
  const double packets = std::clamp(std::floor(longest_ns / packet_ns(load)), 1.0, most_packets);
  const double period_ns = packets * packet_ns(load);
  return {.is_immediate = false,
          .transfer_bytes = load.packet_bytes * static_cast<std::size_t>(packets),
          .transfer_count = count_for(period_ns),
          .transfer_period_ns = std::llround(period_ns)};
}

TransferChoice choose_transfers(const StreamLoad& load, const usb::ScanRequest& request) {
  const bool is_too_slow = packet_ns(load) > static_cast<double>(request.latency_ns);
  const bool is_scan_shorter = kCodeBytes * load.channels < load.packet_bytes;
  const bool is_immediate = is_too_slow && is_scan_shorter && load.scan_hz <= kLargestImmediateHz && !request.must_use_large_packets;
  return is_immediate ? immediate_transfers(load.packet_bytes, load.scan_hz) : block_transfers(load, request.latency_ns);
}

usb::ScanPlan plan_of(const TransferChoice& choice, std::uint8_t endpoint) {
  usb::ScanPlan plan;
  plan.shape.endpoint = endpoint;
  plan.shape.transfer_bytes = choice.transfer_bytes;
  plan.shape.transfer_count = choice.transfer_count;
  const double per_second = core::kNanosecondsPerSecond / static_cast<double>(choice.transfer_period_ns);
  plan.shape.buffer_chunks = std::max<std::size_t>(2 * kFewestTransfers, static_cast<std::size_t>(std::ceil(per_second)) * kBufferSeconds);
  plan.packet_period_ns = choice.transfer_period_ns;
  char text[128];
  std::snprintf(text, sizeof text, "%s: %zu transfers of %zu bytes, one every %.3f ms", choice.is_immediate ? "immediate" : "block",
                choice.transfer_count, choice.transfer_bytes, static_cast<double>(choice.transfer_period_ns) * 1e-6);
  plan.sentence = text;
  return plan;
}

}  // namespace dts::device::mcc
