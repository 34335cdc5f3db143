// SPDX-License-Identifier: Apache-2.0
// Every operation in every state, and what stands in the way of opening.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <thread>

#include "device/usb/usb_daq.h"
#include "unit/device/usb/toy_bench.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using test::kMillisecond;
using test::kSecond;
using test::ToyBench;

constexpr double kRateHz = 1500;

core::Result<core::Rate> start(UsbDaq& daq) { return daq.start({*core::Rate::from_hz(kRateHz), 15}); }

template <class T>
ErrorCode code(const core::Result<T>& result) {
  return result ? ErrorCode{} : result.error().code;
}

/// A toy in a state.
std::unique_ptr<ToyBench> in_state(DeviceState state) {
  auto bench = std::make_unique<ToyBench>();
  if (state == DeviceState::Closed) return bench;
  EXPECT_TRUE(bench->daq->open().has_value());
  if (state == DeviceState::Open) return bench;
  EXPECT_TRUE(bench->start(kRateHz).has_value());
  EXPECT_EQ(bench->read_until_trouble(200 * kMillisecond).outcome, ReadOutcome::Timeout);
  if (state == DeviceState::Streaming) return bench;
  bench->host.bus.unplug(bench->device);
  EXPECT_EQ(bench->read_until_trouble(kSecond).outcome, ReadOutcome::Gone);
  return bench;
}

struct Row {
  const char* name;
  DeviceState state;
  ErrorCode open;
  DeviceState after_open;
  ErrorCode start;
  DeviceState after_start;
  ReadOutcome read;
  DeviceState after_stop;
  ErrorCode sync;
};

constexpr ErrorCode kFine{};
constexpr std::array kTable = {
    Row{"Closed", DeviceState::Closed, kFine, DeviceState::Open, ErrorCode::WrongState, DeviceState::Closed, ReadOutcome::NotStreaming,
        DeviceState::Closed, ErrorCode::WrongState},
    Row{"Open", DeviceState::Open, kFine, DeviceState::Open, kFine, DeviceState::Streaming, ReadOutcome::NotStreaming, DeviceState::Open,
        kFine},
    Row{"Streaming", DeviceState::Streaming, kFine, DeviceState::Streaming, ErrorCode::WrongState, DeviceState::Streaming,
        ReadOutcome::Scans, DeviceState::Open, kFine},
    Row{"Gone", DeviceState::Gone, ErrorCode::WrongState, DeviceState::Gone, ErrorCode::DeviceGone, DeviceState::Gone, ReadOutcome::Gone,
        DeviceState::Gone, ErrorCode::DeviceGone},
};

class UsbDaqState : public testing::TestWithParam<Row> {
 protected:
  std::unique_ptr<ToyBench> bench_ = in_state(GetParam().state);
  UsbDaq& daq_ = *bench_->daq;
};

TEST_P(UsbDaqState, IsWhatItShouldBe) { EXPECT_EQ(daq_.state(), GetParam().state); }

TEST_P(UsbDaqState, Open) {
  EXPECT_EQ(code(daq_.open()), GetParam().open);
  EXPECT_EQ(daq_.state(), GetParam().after_open);
}

TEST_P(UsbDaqState, Start) {
  EXPECT_EQ(code(start(daq_)), GetParam().start);
  EXPECT_EQ(daq_.state(), GetParam().after_start);
}

TEST_P(UsbDaqState, Read) {
  core::Block block(4, 15);
  EXPECT_EQ(daq_.read(block, bench_->host.clock.now_ns() + kSecond).outcome, GetParam().read);
  EXPECT_EQ(block.count() > 0, GetParam().read == ReadOutcome::Scans);
  EXPECT_EQ(daq_.state(), GetParam().state);
}

TEST_P(UsbDaqState, ReadIntoABlockThatDoesNotFit_NothingWritten) {
  core::Block narrow(3, 15);
  core::Block none;
  EXPECT_NE(daq_.read(narrow, 0).outcome, ReadOutcome::Scans);
  EXPECT_NE(daq_.read(none, 0).outcome, ReadOutcome::Scans);
}

TEST_P(UsbDaqState, StopTwice) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(daq_.stop().has_value());
    EXPECT_EQ(daq_.state(), GetParam().after_stop);
  }
}

TEST_P(UsbDaqState, CloseTwice_NothingLeft) {
  for (int i = 0; i < 2; ++i) {
    EXPECT_TRUE(daq_.close().has_value());
    EXPECT_EQ(daq_.state(), DeviceState::Closed);
    EXPECT_EQ(bench_->host.bus.open_ports(), 0);
    EXPECT_EQ(bench_->host.bus.transfers_in_flight(), 0);
  }
}

TEST_P(UsbDaqState, Destroyed_NothingLeft) {
  bench_->daq.reset();
  EXPECT_EQ(bench_->host.bus.open_ports(), 0);
  EXPECT_EQ(bench_->host.bus.transfers_in_flight(), 0);
}

TEST_P(UsbDaqState, SyncOutput) {
  EXPECT_EQ(code(daq_.set_sync_output(true)), GetParam().sync);
  EXPECT_EQ(bench_->device.is_sync_high, GetParam().sync == kFine);
}

TEST_P(UsbDaqState, HarmlessOnes) {
  EXPECT_EQ(daq_.describe().uri, "toy:daq");
  EXPECT_NEAR(daq_.exact_rate(*core::Rate::from_hz(kRateHz))->hz(), kRateHz, 0.1);
  EXPECT_EQ(code(daq_.exact_rate(*core::Rate::from_hz(1e6))), ErrorCode::InvalidArgument);
  EXPECT_EQ(daq_.report().serial, GetParam().state == DeviceState::Closed ? "" : "T1");
  EXPECT_EQ(daq_.report().firmware, GetParam().state == DeviceState::Closed ? "" : "1.07");
  daq_.interrupt();
  EXPECT_EQ(daq_.state(), GetParam().state);
}

TEST_P(UsbDaqState, HasArrived_OncePerPlug) {
  (void)daq_.has_arrived();
  test::ToyDevice other("T2");

  EXPECT_FALSE(daq_.has_arrived());
  bench_->host.bus.plug(other);
  EXPECT_TRUE(daq_.has_arrived());
  EXPECT_FALSE(daq_.has_arrived());
  bench_->host.bus.unplug(other);
}

INSTANTIATE_TEST_SUITE_P(All, UsbDaqState, testing::ValuesIn(kTable), [](const auto& tested) { return std::string(tested.param.name); });

TEST(UsbDaqOpen, NotPluggedIn_NotFoundThenOpens) {
  ToyBench bench;
  bench.host.bus.unplug(bench.device);

  EXPECT_EQ(code(bench.daq->open()), ErrorCode::NotFound);
  bench.host.bus.plug(bench.device);
  EXPECT_TRUE(bench.daq->open().has_value());
}

TEST(UsbDaqOpen, AnotherSerial_SaysWhatIsThereAndWhatToWrite) {
  ToyBench bench({.serial = "X9"});

  const core::Status opened = bench.daq->open();

  ASSERT_EQ(code(opened), ErrorCode::NotFound);
  EXPECT_NE(opened.error().what.find("X9"), std::string::npos);
  EXPECT_EQ(opened.error().hint, "plugged in: Toy T1: write toy:daq?serial=T1");
}

TEST(UsbDaqOpen, TwoUnitsAndNoSerialGiven_ListsThem) {
  ToyBench bench;
  test::ToyDevice other("T2");
  bench.host.bus.plug(other);

  const core::Status opened = bench.daq->open();

  ASSERT_EQ(code(opened), ErrorCode::InvalidArgument);
  EXPECT_NE(opened.error().hint.find("serial=T1"), std::string::npos);
  EXPECT_NE(opened.error().hint.find("serial=T2"), std::string::npos);
  bench.host.bus.unplug(other);
}

TEST(UsbDaqOpen, SeveralUnits_TheOneWithTheSerial) {
  ToyBench bench({.serial = "T2"});
  test::ToyDevice other("T2");
  bench.host.bus.plug(other);

  ASSERT_TRUE(bench.daq->open().has_value());

  EXPECT_EQ(bench.daq->report().serial, "T2");
  EXPECT_EQ(bench.device.requests, 0U);
  bench.daq.reset();
  bench.host.bus.unplug(other);
}

TEST(UsbDaqOpen, SerialNotInTheDescriptors_EachUnitIsAsked) {
  test::Host host;
  test::ToyDevice first("");
  test::ToyDevice second("");
  first.hidden_serial = 1;
  second.hidden_serial = 2;
  host.bus.plug(first);
  host.bus.plug(second);
  auto daq = test::make_toy(host, {.serial = "N2"});
  auto absent = test::make_toy(host, {.serial = "N3"});

  EXPECT_EQ(code(absent->open()), ErrorCode::NotFound);
  ASSERT_TRUE(daq->open().has_value());
  EXPECT_EQ(daq->report().serial, "N2");
  EXPECT_EQ(daq->report().firmware, "7.7");
  EXPECT_EQ(host.bus.open_ports(), 1);
  EXPECT_EQ(code(absent->open()), ErrorCode::WrongState) << "the unit in use may be the one";
  daq.reset();
  host.bus.unplug(first);
  host.bus.unplug(second);
}

TEST(UsbDaqOpen, BusyOrForbidden_SaidSoAndTriedAgain) {
  ToyBench bench;
  bench.host.bus.is_busy = true;
  EXPECT_EQ(code(bench.daq->open()), ErrorCode::WrongState);
  bench.host.bus.is_busy = false;
  bench.host.bus.is_forbidden = true;
  EXPECT_EQ(code(bench.daq->open()), ErrorCode::NotAllowed);
  bench.host.bus.is_forbidden = false;
  EXPECT_TRUE(bench.daq->open().has_value());
}

TEST(UsbDaqOpen, SecondRigOnTheSameUnit_Refused) {
  ToyBench bench;
  auto second = test::make_toy(bench.host, {});
  ASSERT_TRUE(bench.daq->open().has_value());

  EXPECT_EQ(code(second->open()), ErrorCode::WrongState);

  bench.daq->close();
  EXPECT_TRUE(second->open().has_value());
}

TEST(UsbDaqStart, RateOrBlockOutOfLimits_RefusedAndStillOpen) {
  ToyBench bench;
  ASSERT_TRUE(bench.daq->open().has_value());

  EXPECT_EQ(code(bench.daq->start({*core::Rate::from_hz(50'000), 15})), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(bench.daq->start({*core::Rate::from_hz(100), 0})), ErrorCode::InvalidArgument);
  EXPECT_EQ(code(bench.daq->start({*core::Rate::from_hz(100), core::kMaxBlockScans + 1})), ErrorCode::InvalidArgument);
  EXPECT_EQ(bench.daq->state(), DeviceState::Open);
}

TEST(UsbDaqStart, ReportDuringAStart_ReturnsAtOnce) {
  ToyBench bench;
  ASSERT_TRUE(bench.daq->open().has_value());
  int reports = 0;
  bench.host.bus.on_request = [&](std::uint64_t) {  // in the middle of the start: a lock that it held would never be had
    EXPECT_EQ(bench.daq->report().serial, "T1");
    ++reports;
  };

  ASSERT_TRUE(start(*bench.daq).has_value());
  EXPECT_TRUE(bench.daq->stop().has_value());

  EXPECT_GE(reports, 5);
  bench.host.bus.on_request = nullptr;
}

TEST(UsbDaqStart, SyncOutputDuringAStart_SaysTryAgain) {
  ToyBench bench;
  ASSERT_TRUE(bench.daq->open().has_value());
  core::Status told;
  bench.host.bus.on_request = [&](std::uint64_t) {
    bench.host.bus.on_request = nullptr;
    std::jthread([&] { told = bench.daq->set_sync_output(true); }).join();  // within a start that waits for it
  };

  ASSERT_TRUE(start(*bench.daq).has_value());

  ASSERT_EQ(code(told), ErrorCode::WrongState);
  EXPECT_NE(told.error().what.find("busy starting"), std::string::npos);
  EXPECT_EQ(told.error().hint, "try again");
  EXPECT_TRUE(bench.daq->set_sync_output(true).has_value());
  EXPECT_TRUE(bench.device.is_sync_high);
}

TEST(UsbDaqStart, ExactRate_IsWhatTheClockGives) {
  ToyBench bench;
  ASSERT_TRUE(bench.daq->open().has_value());

  const auto rate = start(*bench.daq);

  ASSERT_TRUE(rate.has_value());
  EXPECT_EQ(*rate, *core::Rate::create(40'000'000, 26'667));
  EXPECT_EQ(*rate, *bench.daq->exact_rate(*core::Rate::from_hz(kRateHz)));
}

}  // namespace
}  // namespace dts::device::usb
