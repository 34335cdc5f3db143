// SPDX-License-Identifier: Apache-2.0
#include "device/labjack/u6_timing.h"

#include <algorithm>
#include <array>

#include "core/clock.h"

namespace dts::device::labjack {
namespace {

__extension__ using Wide = __int128;

constexpr std::int64_t kLongestInterval = 65'535;
constexpr std::uint8_t kFastClock = 0x08;
constexpr std::uint8_t kDividedClock = 0x02;
constexpr std::int64_t kShortestPacketNs = 1'000'000;  // more than one packet per USB frame would only add work
constexpr double kMostPacketsPerTransfer = 16.0;

struct Source {
  std::uint8_t scan_config;
  std::int64_t hz;
};
// Fastest first. A faster clock has all rates of a slower clock, except those that need a longer interval than it has.
constexpr std::array kSources = {Source{kFastClock, 48'000'000}, Source{0, 4'000'000}, Source{kFastClock | kDividedClock, 187'500},
                                 Source{kDividedClock, 15'625}};

/// Returns, of the two intervals around the wanted interval, the one with the nearer rate.
std::int64_t nearest_interval(std::int64_t clock_hz, core::Rate wanted) noexcept {
  const Wide ticks = Wide{clock_hz} * wanted.denominator();
  const auto shorter = static_cast<std::int64_t>(std::min<Wide>(ticks / wanted.numerator(), kLongestInterval));
  if (shorter < 1) return 1;
  // The rates clock/shorter and clock/(shorter + 1) are equally near if `wanted` is their mean.
  const bool is_faster_nearer = Wide{2} * wanted.numerator() * shorter * (shorter + 1) >= ticks * (2 * shorter + 1);
  return is_faster_nearer ? shorter : std::min(shorter + 1, kLongestInterval);
}

}  // namespace

ScanClock nearest_clock(core::Rate wanted) noexcept {
  const auto source = std::find_if(kSources.begin(), kSources.end() - 1, [&](const Source& one) {
    return Wide{one.hz} * wanted.denominator() <= Wide{kLongestInterval} * wanted.numerator();
  });
  const std::int64_t interval = nearest_interval(source->hz, wanted);
  ScanClock clock;
  clock.scan_config = source->scan_config;
  clock.interval = static_cast<std::uint16_t>(interval);
  if (const auto rate = core::Rate::create(source->hz, interval)) clock.rate = *rate;
  return clock;
}

Packing pack(core::Rate rate, std::size_t channels, std::int64_t latency_ns, bool must_use_large_packets) noexcept {
  const double latency_s = static_cast<double>(std::max(latency_ns, kShortestPacketNs)) / core::kNanosecondsPerSecond;
  const double scans = latency_s * rate.hz();
  const double packets = scans * static_cast<double>(channels) / static_cast<double>(kMaximumSamplesPerPacket);
  Packing packing;
  if (must_use_large_packets || packets >= 1.0) {
    packing.packets_per_transfer = static_cast<std::size_t>(std::clamp(packets, 1.0, kMostPacketsPerTransfer));
  } else {
    const std::size_t most_scans = std::max<std::size_t>(kMaximumSamplesPerPacket / channels, 1);
    const auto wanted_scans = static_cast<std::size_t>(std::clamp(scans, 1.0, static_cast<double>(most_scans)));
    packing.samples_per_packet = std::min(wanted_scans * channels, kMaximumSamplesPerPacket);
  }
  const auto samples = static_cast<double>(packing.samples_per_packet * packing.packets_per_transfer);
  packing.transfer_period_ns = static_cast<std::int64_t>(samples / static_cast<double>(channels) / rate.hz() * core::kNanosecondsPerSecond);
  return packing;
}

}  // namespace dts::device::labjack
