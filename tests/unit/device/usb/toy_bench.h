// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/clock.h"
#include "device/usb/usb_daq.h"
#include "unit/device/usb/toy_driver.h"
#include "usb/fake/fake_bus.h"

namespace dts::device::usb::test {

inline constexpr std::int64_t kMillisecond = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = 1000 * kMillisecond;

/// Clock and bus that outlive devices under test; nothing may be left on the bus at the end.
struct Host {
  core::VirtualClock clock{kSecond};
  emulator::FakeBus bus{clock};
  bool may_leak = false;

  Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  ~Host() {
    if (may_leak) return;
    EXPECT_EQ(bus.transfers_in_flight(), 0);
    EXPECT_EQ(bus.open_ports(), 0);
  }
};

struct ToySetup {
  ToyDriverOptions driver{};
  std::string serial{};
  bool has_marker = false;
};

inline std::unique_ptr<UsbDaq> make_toy(Host& host, const ToySetup& setup) {
  DaqOptions options;
  options.serial = setup.serial;
  if (setup.has_marker) options.marker = Marker{setup.driver.channels - 1, kToyMarkerCode * kToyVoltsPerCode, 0.1};
  return std::make_unique<UsbDaq>(std::make_unique<ToyDriver>(setup.driver), options, host.bus, host.clock);
}

/// Reads and checks every sample: whatever is delivered is the scan that it says it is.
class Checker {
 public:
  Checker(UsbDaq& daq, std::size_t block_scans, bool has_marker)
      : daq_(daq), block_(daq.describe().channels.size(), block_scans), has_marker_(has_marker) {}

  ReadResult read(std::int64_t deadline_ns) {
    const ReadResult result = daq_.read(block_, deadline_ns);
    if (result.outcome == ReadOutcome::Gap) {
      next_index_ = 0;
      device_scan_ += result.gap.missing_scans;
    }
    EXPECT_EQ(block_.count() > 0, result.outcome == ReadOutcome::Scans);
    check_block();
    return result;
  }
  /// The device's count starts at 0, too.
  void restart() { next_index_ = device_scan_ = 0; }

  core::Block& block() { return block_; }
  [[nodiscard]] std::uint64_t scans() const { return scans_; }
  [[nodiscard]] std::uint64_t wrong() const { return wrong_; }
  [[nodiscard]] std::uint64_t rails() const { return rails_; }

 private:
  void check_block() {
    if (block_.count() > 0 && block_.first_scan.value != next_index_) ++wrong_;
    const std::size_t channels = block_.channel_count();
    for (std::size_t channel = 0; channel < channels; ++channel) {
      const bool is_marker = has_marker_ && channel + 1 == channels;
      for (std::size_t i = 0; i < block_.count(); ++i) {
        const std::uint16_t code = is_marker ? kToyMarkerCode : toy_code(channel, device_scan_ + i);
        if (block_.quality(channel)[i] != 0) {
          ++rails_;
        } else if (block_.column(channel)[i] != code * kToyVoltsPerCode) {
          ++wrong_;
        }
      }
    }
    next_index_ += block_.count();
    device_scan_ += block_.count();
    scans_ += block_.count();
  }

  UsbDaq& daq_;
  core::Block block_;
  bool has_marker_;
  std::uint64_t next_index_ = 0;
  std::uint64_t device_scan_ = 0;
  std::uint64_t scans_ = 0;
  std::uint64_t wrong_ = 0;
  std::uint64_t rails_ = 0;
};

/// One toy on a host, opened and started when asked.
struct ToyBench {
  Host host;
  ToyDevice device;
  ToySetup setup;
  std::unique_ptr<UsbDaq> daq;
  std::optional<Checker> checker;

  explicit ToyBench(ToySetup wanted = {}) : setup(std::move(wanted)) {
    device.has_marker = setup.has_marker;
    host.bus.plug(device);
    daq = make_toy(host, setup);
  }
  ~ToyBench() {
    daq.reset();
    host.bus.unplug(device);
  }

  core::Result<core::Rate> start(double rate_hz, std::size_t block_scans = 15) {
    checker.emplace(*daq, block_scans, setup.has_marker);
    return daq->start({*core::Rate::from_hz(rate_hz), block_scans});
  }
  void run(double rate_hz, std::size_t block_scans = 15) {
    const core::Status opened = daq->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    const auto started = start(rate_hz, block_scans);
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
  }
  /// Reads until something else than scans or nothing comes, or `for_ns` is over.
  ReadResult read_until_trouble(std::int64_t for_ns) {
    const std::int64_t until_ns = host.clock.now_ns() + for_ns;
    while (host.clock.now_ns() < until_ns) {
      const ReadResult result = checker->read(std::min(until_ns, host.clock.now_ns() + 50 * kMillisecond));
      if (result.outcome != ReadOutcome::Scans && result.outcome != ReadOutcome::Timeout) return result;
    }
    return {ReadOutcome::Timeout, {}};
  }
};

}  // namespace dts::device::usb::test
