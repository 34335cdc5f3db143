// SPDX-License-Identifier: Apache-2.0
// The way from sensor to subscriber, with the real daemon.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <memory>
#include <optional>
#include <set>
#include <zmq.hpp>

#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using client::Block;
using client::Event;

/// Receives until `wanted` returns true for a message; false when kPatience is over.
bool receive_until(client::Subscriber& subscriber, const std::function<bool(const client::Message&)>& wanted) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto message = subscriber.receive(std::chrono::milliseconds(100));
    if (message && message->has_value() && wanted(**message)) return true;
  }
  return false;
}

bool is_block(const client::Message& message) { return std::holds_alternative<Block>(message); }

/// A daemon whose device has a fault soon after its start, and a subscriber that sees the fault come.
struct WatchedFault {
  std::unique_ptr<DaemonProcess> daemon;
  std::optional<client::Subscriber> subscriber;
};

/// Subscribes and calls `prepare` before the fault. Begins anew with a later fault where the machine was too slow for that, or
/// `prepare` returned false.
WatchedFault watched_fault(const std::string& fault, const std::vector<std::string>& topics,
                           const std::function<bool(client::ControlClient&)>& prepare = nullptr) {
  WatchedFault watched;
  for (const char* at_s : {"1.5", "6", "24"}) {
    watched.subscriber.reset();
    watched.daemon = std::make_unique<DaemonProcess>(DaemonProcess::Options{.device = "sim:floor?seed=7&" + fault + "&fault_at_s=" + at_s});
    watched.subscriber.emplace(watched.daemon->subscribe(topics));
    auto control = watched.daemon->control();
    if (!receive_until(*watched.subscriber, is_block) || (prepare && !prepare(control))) continue;
    const auto status = control.status();
    if (!status) continue;
    const v1::RigStatus& rig = status->rigs(0);
    if (rig.device() == v1::DEVICE_STATE_STREAMING && rig.segment() == 0 && rig.gaps_total() == 0) return watched;
  }
  ADD_FAILURE() << "the fault always came first: " << watched.daemon->log();
  return watched;
}

TEST(Daemon, Sigterm_EndsWithZeroAndStopsTheSession) {
  RecordProperty("requirement", "CFG-4");
  DaemonProcess daemon;
  ASSERT_TRUE(daemon.is_ready());
  auto control = daemon.control();
  auto subscriber = daemon.subscribe({"floor/session"});
  v1::StartSessionRequest request;
  request.set_rig("floor");
  request.set_protocol("free");
  ASSERT_TRUE(control.start_session(request));
  ASSERT_TRUE(receive_until(subscriber, [](const client::Message& message) {
    const auto* event = std::get_if<Event>(&message);
    return event != nullptr && event->body->session().state() == v1::SESSION_STATE_RUNNING;
  }));

  daemon.signal(SIGTERM);

  EXPECT_EQ(daemon.wait(), 0) << daemon.log();
  EXPECT_FALSE(std::filesystem::exists(daemon.directory() / "control.sock"));
  EXPECT_TRUE(receive_until(subscriber, [](const client::Message& message) {
    const auto* event = std::get_if<Event>(&message);
    return event != nullptr && event->body->session().state() == v1::SESSION_STATE_IDLE;
  })) << "the end of the session must still reach subscribers";
  daemon.restart();
  EXPECT_EQ(daemon.control().list_sessions()->sessions(0).state(), "complete");
}

TEST(Daemon, Sighup_IsHarmless) {
  DaemonProcess daemon;

  daemon.signal(SIGHUP);

  EXPECT_TRUE(eventually([&] { return daemon.log().find("SIGHUP") != std::string::npos; }));
  EXPECT_TRUE(daemon.control().status());
}

TEST(Daemon, Streams_ArriveWithoutHolesAndInStep) {
  RecordProperty("requirement", "SES-4");
  DaemonProcess daemon;
  auto control = daemon.control();
  auto subscriber = daemon.subscribe({"floor/"});
  std::map<std::string, std::uint64_t, std::less<>> next_scan;
  int blocks = 0;

  ASSERT_TRUE(receive_until(subscriber, [&](const client::Message& message) {
    const auto* block = std::get_if<Block>(&message);
    if (block == nullptr) return false;
    const auto expected = next_scan.find(block->stream);
    if (expected != next_scan.end()) {
      EXPECT_EQ(block->first_scan, expected->second) << block->stream;
    }
    EXPECT_EQ(block->lost_scans, 0U);
    next_scan[std::string(block->stream)] = block->first_scan + block->scan_count;
    ++blocks;
    if (blocks == 100) {
      v1::StartSessionRequest request;
      request.set_rig("floor");
      request.set_protocol("free");
      EXPECT_TRUE(control.start_session(request));
    }
    if (blocks == 200) {
      EXPECT_TRUE(control.stop_session("floor"));
    }
    return blocks >= 300;
  }));

  std::set<std::string> streams;
  for (const auto& [stream, next] : next_scan) streams.insert(stream);
  EXPECT_EQ(streams, (std::set<std::string>{"raw", "filtered", "deflection", "cop", "aux"}));
}

TEST(Daemon, Marker_StandsAtAScanThatWasPublished) {
  RecordProperty("requirement", "SES-7");
  DaemonProcess daemon;
  auto subscriber = daemon.subscribe({"floor/raw", "floor/marker"});
  std::uint64_t newest = 0;
  ASSERT_TRUE(receive_until(subscriber, [&](const client::Message& message) {
    if (const auto* block = std::get_if<Block>(&message)) newest = block->first_scan + block->scan_count;
    return newest > 0;
  }));

  const auto marked = daemon.control().mark("heel strike", "floor");

  ASSERT_TRUE(marked) << marked.error().what;
  EXPECT_GE(marked->marks(0).scan() + 1, newest);
  EXPECT_TRUE(receive_until(subscriber, [&](const client::Message& message) {
    if (const auto* block = std::get_if<Block>(&message)) newest = block->first_scan + block->scan_count;
    const auto* event = std::get_if<Event>(&message);
    if (event == nullptr) return false;
    EXPECT_EQ(event->body->marker().text(), "heel strike");
    EXPECT_EQ(event->body->scan(), marked->marks(0).scan());
    return true;
  }));
  const auto reaches_the_scan = [&](const client::Message& message) {
    const auto* block = std::get_if<Block>(&message);
    return block != nullptr && block->first_scan + block->scan_count > marked->marks(0).scan();
  };
  EXPECT_TRUE(newest > marked->marks(0).scan() || receive_until(subscriber, reaches_the_scan)) << "that scan is never published";
}

TEST(Daemon, Unplug_IsToldAndTheSessionGoesOnInTheNextSegment) {
  WatchedFault watched = watched_fault("fault=unplug&fault_for_s=0.5", {"floor/"}, [](client::ControlClient& control) {
    v1::StartSessionRequest request;
    request.set_rig("floor");
    request.set_protocol("free");
    return control.start_session(request).has_value();
  });
  auto control = watched.daemon->control();
  bool has_gone = false;
  std::uint64_t missing = 0;

  EXPECT_TRUE(receive_until(*watched.subscriber, [&](const client::Message& message) {
    if (const auto* event = std::get_if<Event>(&message)) {
      has_gone = has_gone || event->body->device().state() == v1::DEVICE_STATE_GONE;
      if (event->body->has_gap()) missing = event->body->gap().missing_scans();
    }
    const auto* block = std::get_if<Block>(&message);
    return block != nullptr && block->segment == 1 && missing > 0;
  }));

  EXPECT_TRUE(has_gone);
  EXPECT_GE(missing, 45U);
  const auto status = control.status().value();
  EXPECT_EQ(status.rigs(0).session().state(), v1::SESSION_STATE_RUNNING);
  EXPECT_EQ(status.rigs(0).lost_scans_total(), missing);
}

TEST(Daemon, Overrun_IsAGapWithItsExactCount) {
  RecordProperty("requirement", "ACQ-4");
  WatchedFault watched = watched_fault("fault=overrun&fault_for_s=0.25", {"floor/gap", "floor/cop"});
  v1::Gap gap;

  ASSERT_TRUE(receive_until(*watched.subscriber, [&](const client::Message& message) {
    const auto* event = std::get_if<Event>(&message);
    if (event != nullptr) gap = event->body->gap();
    return event != nullptr;
  }));

  EXPECT_EQ(gap.reason(), v1::GAP_REASON_OVERRUN);
  EXPECT_EQ(gap.missing_scans(), 25U);
  EXPECT_TRUE(gap.is_exact());
}

TEST(Daemon, SubscriberThatNeverReads_DisturbsNobodyAndCostsBoundedMemory) {
  RecordProperty("requirement", "PUB-4");
  DaemonProcess daemon({.acquire = "rate_hz = 1500.0\nlow_latency = true"});
  zmq::context_t context(1);
  zmq::socket_t stuck(context, zmq::socket_type::sub);
  stuck.set(zmq::sockopt::rcvhwm, 1);
  stuck.set(zmq::sockopt::linger, 0);
  stuck.set(zmq::sockopt::subscribe, "");
  stuck.connect(daemon.data_endpoint());
  auto healthy = daemon.subscribe({"floor/cop"});
  std::uint64_t lost = 0;
  const auto receive_seconds = [&](int seconds) {
    std::uint64_t scans = 0;
    return receive_until(healthy, [&](const client::Message& message) {
      const auto* block = std::get_if<Block>(&message);
      if (block == nullptr) return false;
      lost += block->lost_scans;
      return (scans += block->scan_count) >= static_cast<std::uint64_t>(seconds) * 1500;
    });
  };
  ASSERT_TRUE(receive_seconds(4));  // fills the stuck one's queue, which holds 2 s
  const long full_kb = resident_kb(daemon.pid());

  ASSERT_TRUE(receive_seconds(2));

  EXPECT_EQ(lost, 0U);
  if (!kIsSanitized) {
    EXPECT_LT(resident_kb(daemon.pid()) - full_kb, 2 * 1024) << "another 2 s would be some 5 MB";
  }
}

}  // namespace
}  // namespace dts::test
