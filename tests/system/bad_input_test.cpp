// SPDX-License-Identifier: Apache-2.0
// What the daemon does with input that is wrong: a clear error or the documented behaviour, and it goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <zmq.hpp>

#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;

/// A DEALER connected to the daemon's control socket.
struct RawClient {
  explicit RawClient(const DaemonProcess& daemon) : socket(context, zmq::socket_type::dealer) {
    socket.set(zmq::sockopt::rcvtimeo, 60'000);
    socket.set(zmq::sockopt::linger, 0);
    socket.connect(daemon.control_endpoint());
  }
  zmq::context_t context{1};
  zmq::socket_t socket;
};

TEST(BadConfiguration, CheckConfig_ExitsTwoAndSaysWhere) {
  const DaemonProcess daemon({.daemon = "[log]\nlevl = \"info\""});

  const Finished checked = run_program({DTSD_PROGRAM, "--config", daemon.config_file(), "--check-config"});

  EXPECT_EQ(checked.status, 2);
  EXPECT_THAT(checked.err, HasSubstr("dtsd.toml:2:1: unknown key 'levl' in [log]; did you mean 'level'?"));
  EXPECT_FALSE(daemon.is_ready());
}

TEST(BadConfiguration, UnknownDeviceOrOption_NamesRigAndSuggestion) {
  for (const char* device : {"sim:flor", "sim:floor?sed=7", "usb:nothing", "sim:floor?seed=7&seed=8", "floor"}) {
    DaemonProcess daemon({.device = device});
    EXPECT_FALSE(daemon.is_ready()) << device;
    EXPECT_EQ(daemon.wait(), 2) << device;
    EXPECT_THAT(daemon.log(), HasSubstr("dtsd.toml:5:10: [[rig]] 'floor'")) << device;
  }
}

TEST(BadConfiguration, MissingFile_ExitsTwo) {
  const Finished finished = run_program({DTSD_PROGRAM, "--config", "/nonexistent/dtsd.toml"});

  EXPECT_EQ(finished.status, 2);
  EXPECT_THAT(finished.err, HasSubstr("/nonexistent/dtsd.toml"));
}

TEST(BadConfiguration, UnknownSwitch_ExitsTwo) { EXPECT_EQ(run_program({DTSD_PROGRAM, "--verbose"}).status, 2); }

TEST(RuntimeDirectory, InUse_SecondDaemonEndsAndTheFirstGoesOn) {
  DaemonProcess first;
  ASSERT_TRUE(first.is_ready());

  const Finished second =
      run_program({DTSD_PROGRAM, "--config", first.config_file()},
                  {"DTSD_RUNTIME_DIR=" + first.directory().string(), "DTSD_STATE_DIR=" + first.state_directory().string()});

  EXPECT_EQ(second.status, 6);
  EXPECT_THAT(second.err, HasSubstr("another dtsd already runs"));
  EXPECT_TRUE(first.control().status());
}

TEST(RuntimeDirectory, SocketOfAnotherDaemon_IsNotStolen) {
  DaemonProcess first;
  ASSERT_TRUE(first.is_ready());

  const DaemonProcess thief({.daemon = "[endpoints]\ncontrol = \"" + first.control_endpoint() + "\""});

  EXPECT_FALSE(thief.is_ready());
  EXPECT_THAT(thief.log(), HasSubstr("already listens"));
  EXPECT_TRUE(first.control().status());
}

TEST(RuntimeDirectory, CannotBeMade_EndsWithPathAndHint) {
  const DaemonProcess any;

  const Finished finished = run_program({DTSD_PROGRAM, "--config", any.config_file()},
                                        {"DTSD_RUNTIME_DIR=/proc/dtsd", "DTSD_STATE_DIR=" + any.state_directory().string()});

  EXPECT_EQ(finished.status, 1);
  EXPECT_THAT(finished.err, HasSubstr("/proc/dtsd"));
}

TEST(ControlMessages, Malformed_AreCountedAnsweredAndHarmless) {
  DaemonProcess daemon;
  RawClient raw(daemon);
  std::mt19937 random(1);
  constexpr int kMessages = 200;

  for (int index = 0; index < kMessages; ++index) {
    std::string bytes(random() % 300, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    bytes.push_back('\xff');  // an unfinished varint: no random draw can be a valid request
    raw.socket.send(zmq::buffer(bytes));
    zmq::message_t reply;
    ASSERT_TRUE(raw.socket.recv(reply));
    v1::Response response;
    ASSERT_TRUE(response.ParseFromString(reply.to_string()));
    EXPECT_EQ(response.error().code(), v1::ERROR_CODE_INVALID_ARGUMENT);
  }

  EXPECT_EQ(daemon.control().status().value().rejected_requests_total(), static_cast<std::uint64_t>(kMessages));
}

TEST(ControlMessages, Oversized_CutTheSenderOffOnly) {
  DaemonProcess daemon;
  RawClient raw(daemon);
  zmq::socket_t monitor(raw.context, zmq::socket_type::pair);
  ASSERT_EQ(zmq_socket_monitor(raw.socket.handle(), "inproc://monitor", ZMQ_EVENT_DISCONNECTED), 0);
  monitor.connect("inproc://monitor");
  monitor.set(zmq::sockopt::rcvtimeo, 60'000);
  ASSERT_TRUE(daemon.control().status());
  const long before_kb = resident_kb(daemon.pid());

  raw.socket.send(zmq::buffer(std::string(64 * 1024 * 1024, 'x')));

  zmq::message_t event;
  EXPECT_TRUE(monitor.recv(event)) << "the daemon must hang up";
  EXPECT_TRUE(daemon.control().status());
  if (!kIsSanitized) {
    EXPECT_LT(resident_kb(daemon.pid()) - before_kb, 16 * 1024);
  }
}

}  // namespace
}  // namespace dts::test
