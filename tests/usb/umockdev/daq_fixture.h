// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>

#include "core/block.h"
#include "device/registry.h"
#include "device/usb/libusb_bus.h"
#include "physics/rig_model.h"
#include "support/patient_clock.h"
#include "usb/umockdev/patient_bus.h"
#include "usb/umockdev/umockdev_host.h"
#include "usb/umockdev/usb_fixture.h"

namespace dts::emulator {

/// What stands at the inputs: every scan and every input has a voltage of its own, so that a sample at the wrong place is seen.
class Staircase {
 public:
  static constexpr double kStepV = 2e-3;
  static constexpr double kInputStepV = 0.4;
  static constexpr double kMarkerV = 4.5;
  static constexpr std::uint64_t kPeriodScans = 100;

  /// The exact rate that the device will run at.
  double rate_hz = 1500.0;
  std::size_t marked = 99;  ///< This input stands at kMarkerV.

  [[nodiscard]] double at(std::size_t input, std::uint64_t scan) const noexcept {
    if (input == marked) return kMarkerV;
    return -2.9 + kInputStepV * static_cast<double>(input) + kStepV * static_cast<double>(scan % kPeriodScans);
  }
  [[nodiscard]] Source source() const {
    return [this](double time_s, std::span<double> volts) {
      // Inputs that are converted one after the other are a little late: still the same scan.
      const auto scan = static_cast<std::uint64_t>(std::floor(time_s * rate_hz + 0.02));
      for (std::size_t input = 0; input < volts.size(); ++input) volts[input] = at(input, scan);
    };
  }
};

/// A whole device, made by the registry, over unmodified libusb, in the time of a PatientClock.
class DaqFixture : public ::testing::Test {
 protected:
  static constexpr double kToleranceV = 0.9e-3;  ///< Less than half a step, more than a code at +-10 V.
  /// The drivers find any fault within 250 ms. A wait for transfers ends by the machine's time, of which a millisecond may be several of
  /// the clock's; exact times are the business of the tests on the fake bus.
  static constexpr double kSoonMs = 500.0;
  static constexpr double kSilenceSoonMs = 1000.0;  ///< A device that says that it runs is waited for.

  DaqFixture() {
    clock_.start([this] { host_.catch_up(); });
  }
  ~DaqFixture() override {
    device_.reset();  // needs the time to pass
    clock_.stop();
  }

  void SetUp() override {
    if (!UmockdevHost::is_available()) GTEST_SKIP() << "this program was not linked with libumockdev-preload";
  }

  void create(const std::string& uri, double rate_hz) {
    auto device = device::create_device(uri, {clock_, rig_, &bus_});
    if (!device) throw std::runtime_error(core::to_string(device.error()));
    device_ = std::move(*device);
    wanted_ = core::Rate::from_hz(rate_hz).value();
    const auto exact = device_->exact_rate(wanted_);
    if (!exact) throw std::runtime_error(core::to_string(exact.error()));
    stairs_.rate_hz = exact->hz();
  }
  void open() {
    if (const auto opened = device_->open(); !opened) throw std::runtime_error(core::to_string(opened.error()));
  }
  void start(std::size_t block_scans = 64) {
    const auto started = device_->start({wanted_, block_scans});
    if (!started) throw std::runtime_error(core::to_string(started.error()));
    EXPECT_DOUBLE_EQ(started->hz(), stairs_.rate_hz);
    block_ = std::make_unique<core::Block>(device_->describe().channels.size(), block_scans);
    heard_ = {};
  }

  struct Heard {
    std::uint64_t scans = 0;
    std::uint64_t wrong = 0;    ///< Samples that are not what stood at the input, and scans out of order.
    device::ReadResult end;     ///< The first result that is neither Scans nor Timeout.
    std::int64_t first_ns = 0;  ///< Host time of scan 0.
    std::int64_t end_ns = 0;    ///< When `end` was told.
  };

  /// Reads until `scans` scans have come since `start`, or the stream ends.
  [[nodiscard]] const Heard& listen(std::uint64_t scans) {
    const std::int64_t give_up_ns = clock_.now_ns() + 60 * std::int64_t{1'000'000'000};
    while (heard_.scans < scans && clock_.now_ns() < give_up_ns) {
      const device::ReadResult result = device_->read(*block_, clock_.now_ns() + 50 * core::kNanosecondsPerMillisecond);
      if (result.outcome == device::ReadOutcome::Scans) {
        check_block();
      } else if (result.outcome != device::ReadOutcome::Timeout) {
        heard_.end = result;
        heard_.end_ns = clock_.now_ns();
        break;
      }
    }
    return heard_;
  }

  /// From the instant of scan `scan` to the word that something is wrong.
  [[nodiscard]] double detection_ms(double scan) const {
    return (static_cast<double>(heard_.end_ns - heard_.first_ns) - scan / stairs_.rate_hz * 1e9) * 1e-6;
  }
  void expect_soon(const char* what, double scan, double limit_ms) const {
    const double ms = detection_ms(scan);
    std::printf("  detected %s %.1f ms after its scan was due (%llu scans read, %llu wrong)\n", what, ms,
                static_cast<unsigned long long>(heard_.scans), static_cast<unsigned long long>(heard_.wrong));
    EXPECT_LT(ms, limit_ms);
  }

  physics::RigModel rig_;
  Staircase stairs_;
  test::PatientClock clock_;
  UmockdevHost host_{Pace::RealTime, &clock_};
  device::usb::LibusbBus libusb_{clock_, {}, core::Log()};
  PatientBus bus_{libusb_};
  std::unique_ptr<device::Device> device_;
  std::unique_ptr<core::Block> block_;
  core::Rate wanted_;
  Heard heard_;

 private:
  void check_block() {
    if (heard_.scans == 0) heard_.first_ns = block_->host_time_ns;
    if (block_->first_scan.value != heard_.scans) ++heard_.wrong;
    for (std::size_t channel = 0; channel < block_->channel_count(); ++channel) {
      for (std::size_t i = 0; i < block_->count(); ++i) {
        const double expected_v = stairs_.at(channel, heard_.scans + i);
        if (!(std::abs(block_->column(channel)[i] - expected_v) <= kToleranceV)) ++heard_.wrong;
      }
    }
    heard_.scans += block_->count();
  }
};

}  // namespace dts::emulator
