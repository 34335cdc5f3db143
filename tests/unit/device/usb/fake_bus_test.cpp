// SPDX-License-Identifier: Apache-2.0
#include "usb/fake/fake_bus.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "unit/device/usb/toy_bench.h"

namespace dts::device::usb {
namespace {

using test::kMillisecond;
using test::kSecond;
using test::kToyEndpoint;
using test::ToyDevice;

struct Heard {
  std::size_t index = 0;
  UsbStatus status = UsbStatus::Completed;
  std::size_t length = 0;
  std::int64_t stamp_ns = 0;
};

class Listener final : public TransferListener {
 public:
  void on_transfer(std::size_t index, UsbStatus status, std::span<const std::uint8_t> bytes, std::int64_t stamp_ns) noexcept override {
    heard.push_back({index, status, bytes.size(), stamp_ns});
  }
  std::vector<Heard> heard;
};

/// A toy of 4 channels that scans at 100 Hz in small packets, one transfer of one packet in flight.
class FakeBusTest : public testing::Test {
 protected:
  FakeBusTest() { host_.bus.plug(device_); }

  void open() {
    const auto units = host_.bus.units(test::kToyModels);
    ASSERT_EQ(units->size(), 1U);
    port_ = std::move(*host_.bus.open(units->front()));
  }
  void scan() {
    open();
    ASSERT_TRUE(driver_.configure(*port_, {*core::Rate::from_hz(100), kMillisecond, false}).has_value());
    ASSERT_TRUE(port_->prepare_transfers(kToyEndpoint, 2, 64, listener_).has_value());
    ASSERT_EQ(port_->submit(0), UsbStatus::Completed);
    ASSERT_TRUE(driver_.begin(*port_).has_value());  // scan 0 comes at once
    begun_ns_ = host_.clock.now_ns();
  }

  test::Host host_;
  ToyDevice device_;
  test::ToyDriver driver_{{.channels = 4}};
  Listener listener_;
  std::unique_ptr<UsbPort> port_;
  std::int64_t begun_ns_ = 0;
};

TEST_F(FakeBusTest, UnitAndEndpoints_AsTheDescriptorsSay) {
  open();
  const UsbUnit unit = host_.bus.units(test::kToyModels)->front();
  EXPECT_EQ(unit.vendor, test::kToyVendor);
  EXPECT_EQ(unit.product, test::kToyProduct);
  EXPECT_EQ(unit.release_bcd, 0x0107);
  EXPECT_EQ(unit.serial, "T1");
  EXPECT_EQ(unit.node(), "/dev/bus/usb/001/002");
  constexpr std::array kOther = {UsbModel{1, 2, "other", "x:y"}};
  EXPECT_TRUE(host_.bus.units(kOther)->empty());
  EXPECT_EQ(port_->max_packet_bytes(kToyEndpoint).value(), 64U);
  EXPECT_EQ(port_->max_packet_bytes(0x82).error().code, core::ErrorCode::NotFound);
  EXPECT_FALSE(port_->prepare_transfers(kToyEndpoint, 2, 65, listener_).has_value());
  EXPECT_FALSE(port_->prepare_transfers(0x82, 2, 64, listener_).has_value());
}

TEST_F(FakeBusTest, RequestStallSilenceAndLoss_EachItsStatusAndTime) {
  open();
  std::array<std::uint8_t, 64> data{};
  std::int64_t before_ns = host_.clock.now_ns();
  EXPECT_EQ(port_->control_in({test::kToyIdentity}, std::span(data).first(3), 100).value(), 3U);
  EXPECT_EQ(data[0], 0xCA);
  EXPECT_EQ(host_.clock.now_ns(), before_ns + host_.bus.request_ns);
  EXPECT_EQ(port_->control_out({99}, {}, 100).error(), UsbStatus::Stall);
  device_.faults.is_mute = true;
  before_ns = host_.clock.now_ns();
  EXPECT_EQ(port_->control_out({test::kToyStop}, {}, 100).error(), UsbStatus::TimedOut);
  EXPECT_EQ(host_.clock.now_ns(), before_ns + host_.bus.request_ns + 100 * kMillisecond);
  host_.bus.unplug(device_);
  EXPECT_EQ(port_->control_out({test::kToyStop}, {}, 100).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port_->bulk_out(0x02, {}, 100).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port_->clear_halt(kToyEndpoint).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 100).error(), UsbStatus::NoDevice);
  EXPECT_EQ(port_->submit(0), UsbStatus::NoDevice);
}

TEST_F(FakeBusTest, Wait_EndsWithThePacketAndItsTimeThenWithTheUnplug) {
  host_.bus.completion_status = [](std::uint64_t number, UsbStatus status) { return number == 1 ? UsbStatus::Failed : status; };
  scan();

  port_->wait(begun_ns_ + kSecond);

  EXPECT_EQ(host_.clock.now_ns(), begun_ns_);
  ASSERT_EQ(listener_.heard.size(), 1U);
  EXPECT_EQ(listener_.heard[0].status, UsbStatus::Completed);
  EXPECT_EQ(listener_.heard[0].length, 8U);
  EXPECT_EQ(listener_.heard[0].stamp_ns, begun_ns_);
  ASSERT_EQ(port_->submit(1), UsbStatus::Completed);
  host_.bus.lateness_ns = [] { return 3 * kMillisecond; };
  port_->wait(begun_ns_ + kSecond);
  ASSERT_EQ(listener_.heard.size(), 2U);
  EXPECT_EQ(listener_.heard[1].index, 1U);
  EXPECT_EQ(listener_.heard[1].status, UsbStatus::Failed);
  EXPECT_EQ(listener_.heard[1].stamp_ns, begun_ns_ + 13 * kMillisecond);

  host_.bus.lateness_ns = nullptr;
  ASSERT_EQ(port_->submit(0), UsbStatus::Completed);
  ASSERT_EQ(port_->submit(1), UsbStatus::Completed);
  host_.bus.unplug(device_);
  port_->wait(begun_ns_ + kSecond);
  ASSERT_EQ(listener_.heard.size(), 4U);
  EXPECT_EQ(listener_.heard[2].status, UsbStatus::NoDevice);
  EXPECT_EQ(listener_.heard[3].status, UsbStatus::NoDevice);
}

TEST_F(FakeBusTest, TransferTwice_RefusedAndCancelHeardWhileWaiting) {
  open();
  EXPECT_EQ(port_->submit(0), UsbStatus::Failed);  // none prepared
  ASSERT_TRUE(port_->prepare_transfers(kToyEndpoint, 2, 64, listener_).has_value());
  EXPECT_EQ(port_->submit(0), UsbStatus::Completed);
  EXPECT_EQ(port_->submit(0), UsbStatus::Failed);
  EXPECT_EQ(port_->submit(2), UsbStatus::Failed);
  EXPECT_EQ(host_.bus.transfers_in_flight(), 1);

  port_->cancel(0);
  port_->cancel(1);
  EXPECT_TRUE(listener_.heard.empty());
  port_->wait(2 * kSecond);
  port_->wait(3 * kSecond);

  EXPECT_EQ(host_.clock.now_ns(), 3 * kSecond) << "no news: the deadline";
  ASSERT_EQ(listener_.heard.size(), 1U);
  EXPECT_EQ(listener_.heard[0].status, UsbStatus::Cancelled);
  EXPECT_EQ(host_.bus.transfers_in_flight(), 0);
  port_->release_transfers();
}

TEST_F(FakeBusTest, LeakedTransfer_Counted) {
  test::Host host;
  host.may_leak = true;
  ToyDevice device;
  host.bus.plug(device);
  auto port = std::move(*host.bus.open(host.bus.units(test::kToyModels)->front()));
  ASSERT_TRUE(port->prepare_transfers(kToyEndpoint, 1, 64, listener_).has_value());
  ASSERT_EQ(port->submit(0), UsbStatus::Completed);
  port.reset();
  EXPECT_EQ(host.bus.transfers_in_flight(), 1);
}

TEST_F(FakeBusTest, BulkIn_PacketsStallAndTimeout) {
  open();
  std::array<std::uint8_t, 64> data{};
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 20).error(), UsbStatus::TimedOut);
  EXPECT_EQ(port_->bulk_in(0x83, data, 20).error(), UsbStatus::Failed);
  ASSERT_TRUE(driver_.configure(*port_, {*core::Rate::from_hz(100), kMillisecond, false}).has_value());
  ASSERT_TRUE(driver_.begin(*port_).has_value());
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 20).value(), 8U);
  device_.faults.stall_at_code = 4;
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 20).error(), UsbStatus::Stall);
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 20).error(), UsbStatus::Stall);
  EXPECT_TRUE(port_->clear_halt(kToyEndpoint).has_value());
  EXPECT_EQ(port_->bulk_in(kToyEndpoint, data, 20).error(), UsbStatus::TimedOut);
}

TEST_F(FakeBusTest, WantsToLeave_GoneAndBackUnderAnotherAddress) {
  open();
  const std::uint64_t arrivals = host_.bus.arrivals();
  device_.wants_out = true;
  port_->wait(host_.clock.now_ns() + kMillisecond);
  EXPECT_TRUE(host_.bus.units(test::kToyModels)->empty());
  EXPECT_EQ(host_.bus.arrivals(), arrivals);

  host_.clock.advance_ns(host_.bus.absence_ns);

  EXPECT_EQ(host_.bus.arrivals(), arrivals + 1);
  ASSERT_EQ(host_.bus.units(test::kToyModels)->size(), 1U);
  EXPECT_EQ(host_.bus.arrivals(), arrivals + 1);
  EXPECT_EQ(host_.bus.units(test::kToyModels)->front().address, 3);
}

}  // namespace
}  // namespace dts::device::usb
