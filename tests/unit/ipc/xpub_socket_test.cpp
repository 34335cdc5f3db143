// SPDX-License-Identifier: Apache-2.0
// The data socket over the real libzmq.
#include "ipc/xpub_socket.h"

#include <gtest/gtest.h>

#include <string>

#include "core/doorbell.h"
#include "dts/v1/stream.pb.h"
#include "unit/record/xdf_fixture.h"

namespace dts::ipc {
namespace {

class XpubSocketTest : public testing::Test {
 protected:
  /// Waits until the subscriber has said something; false: it says nothing within ten seconds.
  [[nodiscard]] bool hears_of_subscription(XpubSocket& socket) {
    for (int turn = 0; turn < 100; ++turn) {
      socket.wait(bell_.fd(), 100);
      if (socket.take_subscriptions()) return true;
    }
    return false;
  }

  record::xdf_test::Folder folder_;
  zmq::context_t context_;
  core::Doorbell bell_;
};

TEST_F(XpubSocketTest, AddressThatOthersCanReach_IsRefusedWithoutKeys) {
  const auto bound = XpubSocket::bind(context_, "tcp://0.0.0.0:5555", 10);

  ASSERT_FALSE(bound);
  EXPECT_EQ(bound.error().code, core::ErrorCode::InvalidArgument);
}

TEST_F(XpubSocketTest, Subscription_IsNoticedOnce_AndServed) {
  const std::string endpoint = "ipc://" + (folder_ / "data");
  const auto socket = XpubSocket::bind(context_, endpoint, 10).value();
  socket->wait(bell_.fd(), 0);
  EXPECT_FALSE(socket->take_subscriptions());
  zmq::socket_t subscriber(context_, zmq::socket_type::xsub);
  subscriber.set(zmq::sockopt::rcvtimeo, 10'000);
  subscriber.connect(endpoint);

  subscriber.send(zmq::str_buffer("\1floor/"));
  EXPECT_TRUE(hears_of_subscription(*socket));
  socket->wait(bell_.fd(), 0);
  EXPECT_FALSE(socket->take_subscriptions());

  dts::v1::Event event;
  event.set_scan(7);
  socket->send("chair/gap", event);
  socket->send("floor/gap", event);
  zmq::message_t topic;
  zmq::message_t payload;
  ASSERT_TRUE(subscriber.recv(topic));
  ASSERT_TRUE(subscriber.recv(payload));
  EXPECT_EQ(topic.to_string(), "floor/gap");
  EXPECT_EQ(payload.to_string(), event.SerializeAsString());

  subscriber.send(zmq::str_buffer("\0floor/"));
  subscriber.send(zmq::str_buffer("\1chair/"));
  EXPECT_TRUE(hears_of_subscription(*socket));
}

/// libzmq's descriptor becomes readable once for each input.
TEST_F(XpubSocketTest, SubscriptionThatWasNotTaken_IsStillThereAfterAnotherWait) {
  const std::string endpoint = "ipc://" + (folder_ / "data");
  const auto socket = XpubSocket::bind(context_, endpoint, 10).value();
  zmq::socket_t subscriber(context_, zmq::socket_type::xsub);
  subscriber.connect(endpoint);
  subscriber.send(zmq::str_buffer("\1floor/"));
  ASSERT_TRUE(hears_of_subscription(*socket));
  subscriber.send(zmq::str_buffer("\1chair/"));
  for (int wait = 0; wait < 100; ++wait) socket->wait(bell_.fd(), 100);  // returns at once when there is input

  EXPECT_TRUE(socket->take_subscriptions());
}

}  // namespace
}  // namespace dts::ipc
