// SPDX-License-Identifier: Apache-2.0
// Data through the relay, with a socket in the place of dtsd.
#include "relay/data_relay.h"

#include "unit/relay/relay_fixture.h"

namespace dts::relay {
namespace {

const std::string kRenewed = "\1dtsd/";
const std::string kEnded = std::string(1, '\0') + "dtsd/";

class DataRelayTest : public RelayFixture {
 protected:
  DataRelayTest() {
    daemon_.set(zmq::sockopt::linger, 0);
    daemon_.set(zmq::sockopt::xpub_verbose, true);
    daemon_.set(zmq::sockopt::sndhwm, 0);
    daemon_.bind(local());
    relay_ = bound([this](const RemoteEndpoint& remote) { return DataRelay::start(context_, remote, local()); });
    expect_subscriptions();
  }
  static Frames next(zmq::socket_t& socket) {
    Frames frames;
    EXPECT_TRUE(eventually([&] { return !(frames = receive_now(socket)).empty(); }));
    return frames;
  }
  zmq::socket_t subscriber(const access::KeyPair& key, const std::string& prefix) {
    zmq::socket_t socket = client(zmq::socket_type::sub, key);
    socket.set(zmq::sockopt::subscribe, prefix);
    return socket;
  }
  /// The relay subscribes to everything, and to what it will renew.
  void expect_subscriptions() {
    EXPECT_EQ(next(daemon_), (Frames{"\1"}));
    EXPECT_EQ(next(daemon_), (Frames{kRenewed}));
  }
  /// The relay renews a part of its subscription; the subscription to everything stays.
  void expect_renewal() {
    EXPECT_EQ(next(daemon_), (Frames{kEnded}));
    EXPECT_EQ(next(daemon_), (Frames{kRenewed}));
  }

  zmq::socket_t daemon_{clients_, zmq::socket_type::xpub};
  std::unique_ptr<DataRelay> relay_;
};

TEST_F(DataRelayTest, MessagesPassUnchanged_ToWhomSubscribes) {
  zmq::socket_t eve = subscriber(eve_, "floor/");
  expect_renewal();
  const std::string body("\0\xff body", 7);
  send(daemon_, {"chair/cop", "other"});
  send(daemon_, {"floor/cop", body});
  send(daemon_, {"floor/empty", ""});

  EXPECT_EQ(next(eve), (Frames{"floor/cop", body}));
  EXPECT_EQ(next(eve), (Frames{"floor/empty", ""}));
}

/// dtsd repeats its retained messages for every new subscription.
TEST_F(DataRelayTest, EveryNewSubscriber_RenewsTheSubscription) {
  const zmq::socket_t eve = subscriber(eve_, "dtsd/status");
  expect_renewal();
  const zmq::socket_t ina = subscriber(ina_, "dtsd/status");
  expect_renewal();
}

TEST_F(DataRelayTest, DroppedPeers_ComeBackByThemselves_ExceptARevokedOne) {
  zmq::socket_t eve = subscriber(eve_, "floor/");
  expect_renewal();
  zmq::socket_t ina = subscriber(ina_, "floor/");
  expect_renewal();
  ASSERT_TRUE(store_->revoke("eve"));
  relay_->drop_peers();
  EXPECT_TRUE(eventually([&] {
    static_cast<void>(receive_now(ina));  // libzmq subscribes again only when its socket is used
    return receive_now(daemon_) == Frames{kEnded};
  }));
  EXPECT_EQ(next(daemon_), (Frames{kRenewed}));
  EXPECT_TRUE(eventually([&] { return authenticator_->refused_total() > 0; }));
  EXPECT_FALSE(relay_->is_down());

  send(daemon_, {"floor/cop", "1"});
  EXPECT_EQ(next(ina), (Frames{"floor/cop", "1"}));
  EXPECT_TRUE(receive_now(eve).empty());
}

TEST_F(DataRelayTest, LongestMessagesPass_ALongerOneEndsItsConnection) {
  zmq::socket_t eve = client(zmq::socket_type::xsub, eve_);
  zmq::socket_t ends = watch(eve);
  const std::string longest(512 - kCurveBytes, 'x');
  send(eve, {"\1floor/"});
  expect_renewal();
  send(eve, {longest});
  send(eve, {"\1chair/"});
  expect_renewal();
  const std::string body(std::size_t{1} << 20U, 'x');
  send(daemon_, {"floor/longest", body});
  EXPECT_EQ(next(eve), (Frames{"floor/longest", body}));
  EXPECT_TRUE(receive_now(ends).empty());

  send(eve, {longest + "x"});
  EXPECT_FALSE(next(ends).empty());
  EXPECT_TRUE(eventually([&] {  // libzmq connects again only when its socket is used
    static_cast<void>(receive_now(eve));
    return receive_now(daemon_) == Frames{kEnded};
  }));
  EXPECT_EQ(next(daemon_), (Frames{kRenewed}));
  send(daemon_, {"floor/longer", body + "x"});
  EXPECT_FALSE(next(ends).empty()) << "dts-relay ended its own connection, and then those of its subscribers: they know of the loss";
}

/// libzmq's and the kernel's own buffers hold some messages more than the queue.
TEST_F(DataRelayTest, QueueOfASubscriberThatDoesNotRead_EndsAt2000) {
  zmq::socket_t eve = unconnected_client(zmq::socket_type::sub, eve_);
  eve.set(zmq::sockopt::rcvhwm, 100);
  eve.set(zmq::sockopt::subscribe, "floor/");
  eve.connect(remote_);
  expect_renewal();
  zmq::socket_t ina = subscriber(ina_, "chair/");
  expect_renewal();
  const std::string body(4000, 'x');
  for (int number = 0; number < 2700; ++number) send(daemon_, {"floor/raw", body});
  send(daemon_, {"chair/passed", ""});
  EXPECT_EQ(next(ina), (Frames{"chair/passed", ""}));
  int accepted = 0;
  EXPECT_TRUE(eventually([&] {
    send(daemon_, {"floor/end", ""});  // is dropped, too, until there is room
    while (true) {
      const Frames frames = receive_now(eve);
      if (frames.empty() || frames[0] == "floor/end") return !frames.empty();
      ++accepted;
    }
  }));
  EXPECT_GE(accepted, 1995);
  EXPECT_LT(accepted, 2600);
}

TEST_F(DataRelayTest, DaemonIsAwayForAWhile_MessagesPassAgain) {
  zmq::socket_t eve = subscriber(eve_, "floor/");
  expect_renewal();
  daemon_.close();
  daemon_ = zmq::socket_t(clients_, zmq::socket_type::xpub);
  daemon_.set(zmq::sockopt::linger, 0);
  daemon_.bind(local());
  expect_subscriptions();

  EXPECT_TRUE(eventually([&] {  // eve was disconnected too, so that she knows of the pause
    send(daemon_, {"floor/cop", "1"});
    return receive_now(eve) == Frames{"floor/cop", "1"};
  }));
}

}  // namespace
}  // namespace dts::relay
