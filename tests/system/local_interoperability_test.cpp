// SPDX-License-Identifier: Apache-2.0
// Other implementations of ZMTP at the local data socket of the real daemon: libzmq here, pyzmq in tests/python/test_plain_zmq.py.
#include <gtest/gtest.h>
#include <signal.h>

#include <array>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <zmq.hpp>

#include "system/daemon_process.h"

namespace dts::test {
namespace {

class LocalInteroperabilityTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(daemon_.is_ready());
    socket_.set(zmq::sockopt::linger, 0);
    socket_.set(zmq::sockopt::rcvtimeo, 50);
  }
  /// Returns the topic of the next message; nothing if none comes at once. Checks that the message is one.
  std::optional<std::string> next() {
    std::array<zmq::message_t, 2> parts;
    if (!socket_.recv(parts[0])) return std::nullopt;
    EXPECT_TRUE(parts[0].more());
    EXPECT_TRUE(socket_.recv(parts[1]).has_value());
    EXPECT_FALSE(parts[1].more());
    const std::string topic = parts[0].to_string();
    const bool is_status = topic == "dtsd/status";
    v1::StatusSnapshot status;
    v1::StreamBlock block;
    google::protobuf::MessageLite& message = is_status ? static_cast<google::protobuf::MessageLite&>(status) : block;
    EXPECT_TRUE(message.ParseFromArray(parts[1].data(), static_cast<int>(parts[1].size())));
    if (!is_status) sequence_ = block.sequence();
    return topic;
  }
  /// Waits until messages of exactly these topics arrive: old ones may still be under way.
  [[nodiscard]] bool gets(const std::set<std::string>& topics) {
    return eventually([&] {
      std::set<std::string> seen;
      for (int i = 0; i < 30; ++i) {
        if (const auto topic = next()) seen.insert(*topic);
      }
      return seen == topics;
    });
  }

  DaemonProcess daemon_;
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::sub};
  std::uint64_t sequence_ = 0;  ///< Of the last block.
};

TEST_F(LocalInteroperabilityTest, Libzmq_SubscribesAndUnsubscribesWhileConnected) {
  RecordProperty("requirement", "PUB-6");
  socket_.connect(daemon_.data_endpoint());
  socket_.set(zmq::sockopt::subscribe, "floor/cop");
  EXPECT_TRUE(gets({"floor/cop"}));
  socket_.set(zmq::sockopt::subscribe, "floor/filtered");
  socket_.set(zmq::sockopt::subscribe, "floor/filtered");
  EXPECT_TRUE(gets({"floor/cop", "floor/filtered"}));
  socket_.set(zmq::sockopt::unsubscribe, "floor/filtered");
  EXPECT_TRUE(gets({"floor/cop", "floor/filtered"})) << "it was subscribed twice";
  socket_.set(zmq::sockopt::unsubscribe, "floor/filtered");
  EXPECT_TRUE(gets({"floor/cop"}));
  socket_.set(zmq::sockopt::unsubscribe, "floor/cop");
  EXPECT_TRUE(gets({}));
  socket_.set(zmq::sockopt::subscribe, "dtsd/");
  EXPECT_TRUE(gets({"dtsd/status"}));
}

TEST_F(LocalInteroperabilityTest, Libzmq_ConnectsAgainWhenTheDaemonStartsAgain) {
  socket_.set(zmq::sockopt::heartbeat_ivl, 100);
  socket_.set(zmq::sockopt::heartbeat_timeout, 10'000);
  socket_.set(zmq::sockopt::subscribe, "floor/cop");
  socket_.connect(daemon_.data_endpoint());
  EXPECT_TRUE(gets({"floor/cop"}));
  EXPECT_TRUE(eventually([&] { return next() && sequence_ > 50; }));  // a second, with heartbeats
  daemon_.signal(SIGTERM);
  EXPECT_EQ(daemon_.wait(), 0);
  daemon_.restart();
  ASSERT_TRUE(daemon_.is_ready());
  EXPECT_TRUE(eventually([&] { return next() && sequence_ < 50; })) << "of the new run";
  EXPECT_TRUE(gets({"floor/cop"}));
}

TEST_F(LocalInteroperabilityTest, Libzmq_XsubSocketSendsSubscriptionsItself) {
  zmq::socket_t xsub(context_, zmq::socket_type::xsub);
  xsub.set(zmq::sockopt::linger, 0);
  xsub.set(zmq::sockopt::rcvtimeo, 50);
  xsub.connect(daemon_.data_endpoint());
  for (const char* text : {"one part", "two parts"}) xsub.send(zmq::buffer(std::string(text)), zmq::send_flags::sndmore);
  xsub.send(zmq::buffer(std::string("\1floor/cop")), zmq::send_flags::none);  // the last part of a message, which is no subscription
  xsub.send(zmq::buffer(std::string("\1floor/cop")), zmq::send_flags::none);
  socket_ = std::move(xsub);
  EXPECT_TRUE(gets({"floor/cop"}));
}

TEST_F(LocalInteroperabilityTest, LibzmqWithCurve_IsRefusedAndOthersAreServed) {
  std::array<char, 41> public_key{};
  std::array<char, 41> secret_key{};
  ASSERT_EQ(::zmq_curve_keypair(public_key.data(), secret_key.data()), 0);
  zmq::socket_t curve(context_, zmq::socket_type::sub);
  curve.set(zmq::sockopt::linger, 0);
  curve.set(zmq::sockopt::rcvtimeo, 500);
  curve.set(zmq::sockopt::curve_serverkey, std::string(public_key.data()));
  curve.set(zmq::sockopt::curve_publickey, std::string(public_key.data()));
  curve.set(zmq::sockopt::curve_secretkey, std::string(secret_key.data()));
  curve.set(zmq::sockopt::subscribe, "");
  curve.connect(daemon_.data_endpoint());
  socket_.set(zmq::sockopt::subscribe, "floor/cop");
  socket_.connect(daemon_.data_endpoint());
  zmq::message_t message;
  EXPECT_FALSE(curve.recv(message));
  EXPECT_TRUE(gets({"floor/cop"}));
}

}  // namespace
}  // namespace dts::test
