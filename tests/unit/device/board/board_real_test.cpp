// SPDX-License-Identifier: Apache-2.0
// Boards behind real descriptors, in real time: a pseudo-terminal, a socket, a child process.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "board/fd_board.h"
#include "device/registry.h"
#include "support/sanitized.h"
#include "unit/device/board/board_rig.h"

namespace dts::device::board::test {
namespace {

/// A real device with the system's clock.
struct RealRig {
  explicit RealRig(const std::string& uri) {
    auto created = create_device(uri, {clock, plate, nullptr, {.are_allowed = true}});
    EXPECT_TRUE(created.has_value()) << (created ? "" : core::to_string(created.error()));
    if (created) device = std::move(*created);
  }
  void start(double rate_hz) {
    core::Status opened;
    for (const std::int64_t until_ns = clock.now_ns() + 30 * kSecond; clock.now_ns() < until_ns;) {
      opened = device->open();
      if (opened) break;
      clock.sleep_until_ns(clock.now_ns() + 20 * kMs);
    }
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
    const auto started = device->start({rate_of(rate_hz), 64});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
    witness.restart();
  }
  /// Reads until `scans` more scans have arrived; at most 30 s.
  void read_scans(std::uint64_t scans) {
    const std::uint64_t until = witness.scans + scans;
    for (const std::int64_t until_ns = clock.now_ns() + 30 * kSecond; witness.scans < until && clock.now_ns() < until_ns;) {
      const ReadOutcome outcome = witness.read(*device, clock.now_ns() + 100 * kMs).outcome;
      ASSERT_TRUE(outcome == ReadOutcome::Scans || outcome == ReadOutcome::Timeout || outcome == ReadOutcome::Gap);
    }
    EXPECT_GE(witness.scans, until);
  }
  void expect_nothing_hidden() const {
    EXPECT_EQ(witness.wrong_values, 0U);
    EXPECT_EQ(witness.hidden_losses, 0U);
    EXPECT_EQ(witness.wrong_counts, 0U);
  }

  core::SystemClock clock;
  physics::RigModel plate = device::test::floor_rig();
  std::unique_ptr<Device> device;
  Witness witness{4};
};

TEST(RealBoard, AtASerialPort_StreamsStopsAndComesBackAfterAReplug) {
  dts::test::PtyBoard board({});
  RealRig rig("serial:" + board.path() + "?channels=4");
  rig.start(1000.0);
  rig.read_scans(300);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(1000.0);
  rig.read_scans(300);
  board.unplug();
  ReadResult result;
  for (int i = 0; i < 300 && result.outcome != ReadOutcome::Gone; ++i)
    result = rig.witness.read(*rig.device, rig.clock.now_ns() + 100 * kMs);
  EXPECT_EQ(result.outcome, ReadOutcome::Gone);
  EXPECT_TRUE(rig.device->close().has_value());
  board.plug();
  rig.start(1000.0);
  rig.read_scans(300);
  rig.expect_nothing_hidden();
}

TEST(RealBoard, LinesAtASerialPort_AreScans) {
  dts::test::PtyBoard board({.speaks_lines = true, .rate = {500, 1}, .has_counter = true});
  RealRig rig("serial:" + board.path() + "?channels=4&format=lines&rate_hz=500&counter=1");
  rig.start(500.0);
  rig.read_scans(300);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.expect_nothing_hidden();
}

TEST(RealBoard, Interrupt_EndsAWaitingRead) {
  dts::test::PtyBoard board({});
  RealRig rig("serial:" + board.path() + "?channels=4");
  rig.start(1.0);
  std::atomic<bool> has_returned{false};
  std::jthread reader([&] {
    core::Block block(4, 64);
    (void)rig.device->read(block, kNoDeadline);
    has_returned.store(true, std::memory_order_release);
  });
  while (!has_returned.load(std::memory_order_acquire)) {
    rig.device->interrupt();
    std::this_thread::yield();
  }
  reader.join();
  EXPECT_TRUE(rig.device->close().has_value());
}

TEST(RealBoard, AtATcpPort_Streams) {
  const int listener = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ASSERT_EQ(::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ASSERT_EQ(::listen(listener, 1), 0);
  socklen_t length = sizeof address;
  ASSERT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &length), 0);
  std::atomic<bool> must_stop{false};
  std::jthread server([&] {
    const int connection = ::accept(listener, nullptr, nullptr);
    dts::test::FakeBoard board({}, core::SystemClock().now_ns());
    dts::test::Damage damage;
    std::mutex mutex;
    dts::test::run_board(board, connection, connection, damage, mutex, must_stop);
    ::close(connection);
  });

  RealRig rig("tcp:127.0.0.1:" + std::to_string(ntohs(address.sin_port)) + "?channels=4");
  rig.start(1000.0);
  rig.read_scans(300);
  EXPECT_TRUE(rig.device->close().has_value());
  must_stop.store(true, std::memory_order_release);
  server.join();
  ::close(listener);
  rig.expect_nothing_hidden();
}

TEST(RealBoard, AProgram_Streams) {
  if (dts::test::kIsSanitized) GTEST_SKIP() << "a sanitizer needs more memory than a program of exec: may have";
  RealRig rig(std::string("exec:") + DTS_FAKE_BOARD + "?channels=4");
  rig.start(1000.0);
  rig.read_scans(300);
  EXPECT_TRUE(rig.device->stop().has_value());
  rig.start(1000.0);
  rig.read_scans(300);
  EXPECT_TRUE(rig.device->close().has_value());
  rig.expect_nothing_hidden();
}

TEST(RealBoard, AProgramThatIsNotAllowed_IsNotCreated) {
  core::SystemClock clock;
  const physics::RigModel plate = device::test::floor_rig();
  const auto created = create_device("exec:/bin/true?channels=4", {clock, plate});
  ASSERT_FALSE(created.has_value());
  EXPECT_EQ(created.error().code, core::ErrorCode::NotAllowed);
}

}  // namespace
}  // namespace dts::device::board::test
