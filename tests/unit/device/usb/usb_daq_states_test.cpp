// SPDX-License-Identifier: Apache-2.0
// Every operation in every state, and what stands in the way of opening.
#include <gtest/gtest.h>

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

// What every device does in every state is in tests/contract.
TEST(UsbDaqState, EveryState_HarmlessCallsChangeNothingAndTheEndLeavesNothing) {
  for (const DeviceState state : {DeviceState::Closed, DeviceState::Open, DeviceState::Streaming, DeviceState::Gone}) {
    SCOPED_TRACE(static_cast<int>(state));
    in_state(state).reset();  // destroyed as it is: the host looks at what is left
    const auto bench = in_state(state);
    UsbDaq& daq = *bench->daq;
    ASSERT_EQ(daq.state(), state);
    const bool is_closed = state == DeviceState::Closed;
    core::Block narrow(3, 15);
    core::Block none;
    EXPECT_NE(daq.read(narrow, 0).outcome, ReadOutcome::Scans);
    EXPECT_NE(daq.read(none, 0).outcome, ReadOutcome::Scans);
    EXPECT_EQ(code(daq.exact_rate(*core::Rate::from_hz(1e6))), ErrorCode::InvalidArgument);
    EXPECT_EQ(daq.report().serial, is_closed ? "" : "T1");
    EXPECT_EQ(daq.report().firmware, is_closed ? "" : "1.07");
    daq.interrupt();
    const ErrorCode sync = code(daq.set_sync_output(true));
    EXPECT_EQ(sync, is_closed ? ErrorCode::WrongState : state == DeviceState::Gone ? ErrorCode::DeviceGone : ErrorCode{});
    EXPECT_EQ(bench->device.is_sync_high, sync == ErrorCode{});
    EXPECT_EQ(daq.state(), state);

    (void)daq.has_arrived();
    test::ToyDevice other("T2");
    EXPECT_FALSE(daq.has_arrived());
    bench->host.bus.plug(other);
    EXPECT_TRUE(daq.has_arrived());
    EXPECT_FALSE(daq.has_arrived());
    bench->host.bus.unplug(other);

    for (int i = 0; i < 2; ++i) {
      EXPECT_TRUE(daq.close().has_value());
      EXPECT_EQ(daq.state(), DeviceState::Closed);
      EXPECT_EQ(bench->host.bus.open_ports(), 0);
    }
  }
}

TEST(UsbDaqOpen, AbsentBusyForbiddenOrInUse_SaidSoAndOpenedLater) {
  ToyBench bench;
  bench.host.bus.unplug(bench.device);
  EXPECT_EQ(code(bench.daq->open()), ErrorCode::NotFound);
  bench.host.bus.plug(bench.device);
  bench.host.bus.is_busy = true;
  EXPECT_EQ(code(bench.daq->open()), ErrorCode::WrongState);
  bench.host.bus.is_busy = false;
  bench.host.bus.is_forbidden = true;
  EXPECT_EQ(code(bench.daq->open()), ErrorCode::NotAllowed);
  bench.host.bus.is_forbidden = false;
  EXPECT_TRUE(bench.daq->open().has_value());

  auto second = test::make_toy(bench.host, {});
  EXPECT_EQ(code(second->open()), ErrorCode::WrongState);
  bench.daq->close();
  EXPECT_TRUE(second->open().has_value());
}

TEST(UsbDaqOpen, SerialDecides_ElseTheErrorListsWhatIsThere) {
  ToyBench bench;
  test::ToyDevice other("T2");
  const auto absent = test::make_toy(bench.host, {.serial = "X9"});
  const auto second = test::make_toy(bench.host, {.serial = "T2"});

  const core::Status not_there = absent->open();
  ASSERT_EQ(code(not_there), ErrorCode::NotFound);
  EXPECT_NE(not_there.error().what.find("X9"), std::string::npos);
  EXPECT_EQ(not_there.error().hint, "plugged in: Toy T1: write toy:daq?serial=T1");

  bench.host.bus.plug(other);
  const core::Status ambiguous = bench.daq->open();
  ASSERT_EQ(code(ambiguous), ErrorCode::InvalidArgument);
  EXPECT_NE(ambiguous.error().hint.find("serial=T1"), std::string::npos);
  EXPECT_NE(ambiguous.error().hint.find("serial=T2"), std::string::npos);

  ASSERT_TRUE(second->open().has_value());
  EXPECT_EQ(second->report().serial, "T2");
  EXPECT_EQ(bench.device.requests, 0U);
  second->close();
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
