// SPDX-License-Identifier: Apache-2.0
// What the daemon does with input that is wrong: a clear error or the documented behaviour, and it goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <fstream>
#include <random>
#include <zmq.hpp>

#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;

/// Sends frames as one multipart message and returns the answer's last frame, or nothing.
std::optional<std::string> exchange(zmq::socket_t& socket, const std::vector<std::string>& frames) {
  for (std::size_t index = 0; index < frames.size(); ++index) {
    socket.send(zmq::buffer(frames[index]), index + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
  }
  std::string last;
  for (bool has_more = true; has_more;) {
    zmq::message_t part;
    if (!socket.recv(part)) return std::nullopt;
    last = part.to_string();
    has_more = part.more();
  }
  return last;
}

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

std::string serialised(const std::string& id, const std::function<void(v1::Request&)>& fill) {
  v1::Request request;
  request.set_request_id(id);
  fill(request);
  return request.SerializeAsString();
}

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
    const auto reply = exchange(raw.socket, {bytes});
    ASSERT_TRUE(reply);
    v1::Response response;
    ASSERT_TRUE(response.ParseFromString(*reply));
    EXPECT_EQ(response.error().code(), v1::ERROR_CODE_INVALID_ARGUMENT);
  }

  EXPECT_EQ(daemon.control().status().value().rejected_requests_total(), static_cast<std::uint64_t>(kMessages));
}

TEST(ControlMessages, TooManyFrames_AreRejected) {
  DaemonProcess daemon;
  RawClient raw(daemon);

  EXPECT_TRUE(exchange(raw.socket, {"a", "b", "c", "d", "e"}));
  EXPECT_TRUE(exchange(raw.socket, {"not empty", "x"}));

  EXPECT_EQ(daemon.control().status().value().rejected_requests_total(), 2U);
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

TEST(ControlMessages, RequestIdMissingOrTooLong_IsRejected) {
  DaemonProcess daemon;
  RawClient raw(daemon);
  for (const std::string& id : {std::string(), std::string(65, 'i')}) {
    const auto reply = exchange(raw.socket, {serialised(id, [](v1::Request& request) { request.mutable_status(); })});
    v1::Response response;
    ASSERT_TRUE(reply && response.ParseFromString(*reply));
    EXPECT_EQ(response.error().code(), v1::ERROR_CODE_INVALID_ARGUMENT);
  }
}

TEST(ControlMessages, ReqSocketWithDelimiter_IsServedToo) {
  DaemonProcess daemon;
  zmq::context_t context(1);
  zmq::socket_t socket(context, zmq::socket_type::req);
  socket.set(zmq::sockopt::rcvtimeo, 60'000);
  socket.set(zmq::sockopt::linger, 0);
  socket.connect(daemon.control_endpoint());

  const auto reply = exchange(socket, {serialised("r1", [](v1::Request& request) { request.mutable_list_rigs(); })});

  v1::Response response;
  ASSERT_TRUE(reply && response.ParseFromString(*reply));
  EXPECT_EQ(response.rigs().rigs(0).name(), "floor");
}

TEST(ControlMessages, SameRequestIdTwice_IsExecutedOnce) {
  DaemonProcess daemon;
  RawClient raw(daemon);
  const std::string start = serialised("once", [](v1::Request& request) { request.mutable_start_session()->set_rig("floor"); });

  const auto first = exchange(raw.socket, {start});
  RawClient reconnected(daemon);
  const auto second = exchange(reconnected.socket, {start});

  ASSERT_TRUE(first && second);
  EXPECT_EQ(*first, *second);
  v1::Response response;
  ASSERT_TRUE(response.ParseFromString(*second));
  EXPECT_FALSE(response.session().session_id().empty()) << "a second start would be refused with wrong_state";
}

TEST(ControlMessages, SameRequestIdForAnotherCommand_IsRefused) {
  DaemonProcess daemon;
  ASSERT_TRUE(eventually([&] { return daemon.control().mark("before", "").has_value(); }));
  RawClient raw(daemon);
  ASSERT_TRUE(exchange(raw.socket, {serialised("1", [](v1::Request& request) { request.mutable_mark()->set_text("a"); })}));

  const auto reply =
      exchange(raw.socket, {serialised("1", [](v1::Request& request) { request.mutable_start_session()->set_rig("floor"); })});

  v1::Response response;
  ASSERT_TRUE(reply && response.ParseFromString(*reply));
  EXPECT_EQ(response.error().code(), v1::ERROR_CODE_INVALID_ARGUMENT);
}

TEST(Commands, TareOfASilentRig_IsWithdrawnWhenItTimesOut) {
  DaemonProcess daemon({.device = "sim:floor?fault=silence&fault_at_s=0.3&fault_for_s=3600", .stages = ""});
  ASSERT_TRUE(eventually([&] { return daemon.control().status().value().rigs(0).scans_total() > 0; }));

  const auto tared = daemon.control().tare("floor");

  ASSERT_FALSE(tared);
  EXPECT_EQ(tared.error().code, client::ErrorCode::Timeout);
}

TEST(Commands, UnknownRig_IsNotFound) {
  DaemonProcess daemon;
  auto control = daemon.control();
  v1::StartSessionRequest request;
  request.set_rig("chair");

  EXPECT_EQ(control.start_session(request).error().code, client::ErrorCode::NotFound);
  EXPECT_EQ(control.stop_session("chair").error().code, client::ErrorCode::NotFound);
  EXPECT_EQ(control.tare("chair").error().code, client::ErrorCode::NotFound);
  EXPECT_EQ(control.mark("x", "chair").error().code, client::ErrorCode::NotFound);
  EXPECT_EQ(control.test_device("chair").error().code, client::ErrorCode::NotFound);
}

TEST(Commands, StartTwiceAndStopWhenIdle_AreWrongState) {
  DaemonProcess daemon;
  auto control = daemon.control();
  v1::StartSessionRequest request;
  request.set_rig("floor");

  EXPECT_EQ(control.stop_session("floor").error().code, client::ErrorCode::WrongState);
  ASSERT_TRUE(control.start_session(request));
  EXPECT_EQ(control.start_session(request).error().code, client::ErrorCode::WrongState);
  EXPECT_TRUE(control.stop_session(""));
  EXPECT_EQ(control.stop_session("").error().code, client::ErrorCode::WrongState);
}

TEST(Commands, SenselessFields_AreInvalidArgument) {
  DaemonProcess daemon;
  auto control = daemon.control();
  v1::StartSessionRequest named;
  named.set_rig("floor");
  named.set_subject("Jane Doe");
  v1::StartSessionRequest endless = named;
  endless.clear_subject();
  endless.set_duration_s(-1);

  EXPECT_EQ(control.start_session(named).error().code, client::ErrorCode::InvalidArgument);
  EXPECT_EQ(control.start_session(endless).error().code, client::ErrorCode::InvalidArgument);
  EXPECT_TRUE(control.status());
}

}  // namespace
}  // namespace dts::test
