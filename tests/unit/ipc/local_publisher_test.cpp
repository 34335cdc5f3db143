// SPDX-License-Identifier: Apache-2.0
// The local data socket: with libzmq's SUB sockets, and with peers that a test scripts byte by byte.
#include "ipc/local_publisher.h"

#include <gmock/gmock.h>
#include <poll.h>
#include <signal.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "core/doorbell.h"
#include "dts/v1/stream.pb.h"
#include "dts/zmtp/zmtp.h"
#include "support/allocation_counter.h"
#include "unit/record/xdf_fixture.h"

namespace dts::ipc {
namespace {

using testing::HasSubstr;

std::string frame(const std::string& body, bool has_more = false) {
  std::string bytes;
  zmtp::append_frame(bytes, body, has_more);
  return bytes;
}
std::string command(const std::string& name, const std::string& data) {
  std::string bytes;
  zmtp::append_command(bytes, name, data);
  return bytes;
}
std::string ready(const std::string& type) {
  std::string bytes;
  zmtp::append_ready(bytes, type);
  return bytes;
}
dts::v1::Event event(std::uint64_t scan) {
  dts::v1::Event made;
  made.set_scan(scan);
  return made;
}
dts::v1::StreamBlock block_of_1_kb() {
  dts::v1::StreamBlock block;
  for (int i = 0; i < 250; ++i) block.add_values(1.0F);
  return block;
}
std::string message(const std::string& topic, const google::protobuf::MessageLite& sent) {
  return frame(topic, true) + frame(sent.SerializeAsString());
}
const std::string kOpening = zmtp::greeting() + ready("SUB");
const std::string kAnswer = zmtp::greeting() + ready("XPUB");

/// A connection that sends what a test wants.
class RawPeer {
 public:
  explicit RawPeer(const std::string& path) : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  ~RawPeer() { ::close(fd_); }
  RawPeer(RawPeer&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  RawPeer& operator=(RawPeer&&) = delete;

  /// Returns false if the other side has closed the connection.
  [[nodiscard]] bool send(const std::string& bytes) const {
    return ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT) == static_cast<ssize_t>(bytes.size());
  }
  /// Returns what has arrived, without waiting.
  std::string received() const {
    std::string bytes(std::size_t{256} << 10U, '\0');
    const ssize_t count = ::recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    return bytes;
  }
  /// Returns everything until the other side closes or nothing more arrives.
  std::string all_received() const {
    std::string all;
    for (std::string more = received(); !more.empty(); more = received()) all += more;
    return all;
  }
  [[nodiscard]] bool is_closed() const {
    pollfd waited{.fd = fd_, .events = POLLIN | POLLRDHUP, .revents = 0};
    return ::poll(&waited, 1, 0) == 1 && (waited.revents & (POLLHUP | POLLRDHUP)) != 0;
  }

 private:
  int fd_;
};

class LocalPublisherTest : public testing::Test {
 protected:
  /// Lets the publish thread take a turn; returns whether there was a new subscription.
  bool turn(int timeout_ms = 0) {
    publisher_->wait(bell_.fd(), timeout_ms);
    return publisher_->take_subscriptions();
  }
  /// Turns until everything that peers have sent so far is processed.
  bool turns(int count = 50) {
    bool has_new = false;
    for (int i = 0; i < count; ++i) has_new |= turn();
    return has_new;
  }
  [[nodiscard]] bool notices_a_subscription() {
    for (int i = 0; i < 1000; ++i) {
      if (turn(10)) return true;
    }
    return false;
  }
  [[nodiscard]] bool turn_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 1000; ++i) {
      if (condition()) return true;
      turn(10);
    }
    return false;
  }
  void publish(const std::string& topic, const google::protobuf::MessageLite& sent) {
    publisher_->send(topic, sent);
    static_cast<void>(publisher_->flush(LocalPublisher::kMostPeers));
  }
  RawPeer subscriber(const std::string& prefix) {
    RawPeer peer(path_);
    EXPECT_TRUE(peer.send(kOpening + frame("\1" + prefix)));
    EXPECT_TRUE(turns());
    EXPECT_EQ(peer.received(), kAnswer);
    return peer;
  }

  record::xdf_test::Folder folder_;
  std::string path_ = folder_ / "data";
  core::VirtualClock clock_{1'000'000'000};
  core::Doorbell bell_;
  std::ostringstream said_;
  core::Log log_{std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(said_))};
  std::unique_ptr<LocalPublisher> publisher_ = LocalPublisher::bind("ipc://" + path_, clock_, log_).value();
};

TEST_F(LocalPublisherTest, SubSocketsOfLibzmq_AreServedWhatTheySubscribe) {
  zmq::context_t context;
  zmq::socket_t subscriber(context, zmq::socket_type::sub);
  subscriber.set(zmq::sockopt::rcvtimeo, 10'000);
  subscriber.set(zmq::sockopt::heartbeat_ivl, 10);
  subscriber.set(zmq::sockopt::heartbeat_timeout, 10'000);  // by default 10 ms: a busy machine would lose the connection
  subscriber.set(zmq::sockopt::subscribe, "floor/");
  subscriber.connect("ipc://" + path_);
  ASSERT_TRUE(notices_a_subscription());
  EXPECT_FALSE(turn()) << "once is enough";
  const auto receives = [&](const std::string& topic, std::uint64_t scan) {
    zmq::message_t parts[2];
    for (auto& part : parts) ASSERT_TRUE(subscriber.recv(part));
    EXPECT_EQ(parts[0].to_string(), topic);
    EXPECT_EQ(parts[1].to_string(), event(scan).SerializeAsString());
  };
  publish("chair/gap", event(1));
  publish("floor/gap", event(2));
  receives("floor/gap", 2);

  subscriber.set(zmq::sockopt::unsubscribe, "floor/");
  subscriber.set(zmq::sockopt::subscribe, "chair/");
  ASSERT_TRUE(notices_a_subscription());
  publish("floor/gap", event(3));
  publish("chair/gap", event(4));
  receives("chair/gap", 4);

  dts::v1::Event large;
  large.mutable_marker()->set_text(std::string(1'000'000, 'x'));
  publisher_->send("chair/marker", large);
  static_cast<void>(publisher_->flush(LocalPublisher::kMostPeers));
  ASSERT_TRUE(turn_until([&] {
    zmq::pollitem_t item{.socket = subscriber.handle(), .fd = 0, .events = ZMQ_POLLIN, .revents = 0};
    return zmq::poll(&item, 1, std::chrono::milliseconds(0)) > 0;
  }));
  zmq::message_t parts[2];
  for (auto& part : parts) ASSERT_TRUE(subscriber.recv(part));
  EXPECT_EQ(parts[1].to_string(), large.SerializeAsString()) << "longer than a queue, but the queue was empty";

  for (int i = 0; i < 20; ++i) turn(10);  // heartbeats do no harm
  EXPECT_EQ(publisher_->peers(), 1U);
  subscriber.close();
  EXPECT_TRUE(turn_until([&] { return publisher_->peers() == 0; }));
}

TEST_F(LocalPublisherTest, HandshakeByteByByte_IsUnderstood) {
  const RawPeer peer(path_);
  for (const char byte : kOpening + frame("\1a") + command("PING", std::string("\0\x0a", 2) + "now")) {
    ASSERT_TRUE(peer.send(std::string(1, byte)));
    turn();
    turn();
  }
  publish("abc", event(7));
  EXPECT_EQ(peer.all_received(), kAnswer + command("PONG", "now") + message("abc", event(7)));
}

TEST_F(LocalPublisherTest, Subscriptions_AreASetOfPrefixes) {
  const RawPeer peer = subscriber("a");
  const auto after = [&](const std::string& change, const std::string& topic) {
    EXPECT_TRUE(peer.send(change));
    turns();
    publish(topic, event(1));
    return !peer.all_received().empty();
  };
  EXPECT_TRUE(after(frame("\1a"), "a/b")) << "twice is once";
  EXPECT_FALSE(after(frame(std::string("\0a", 2)), "a/b"));
  EXPECT_FALSE(after(frame(std::string("\0never", 6)), "a/b"));
  EXPECT_TRUE(after(frame("\1"), "a/b")) << "an empty prefix is everything";
  EXPECT_FALSE(after(frame(std::string("\0", 1)), "a/b"));
  EXPECT_TRUE(after(command("SUBSCRIBE", "a/"), "a/b")) << "as peers of ZMTP 3.1 do";
  EXPECT_FALSE(after("", "a")) << "a longer prefix";
  EXPECT_FALSE(after(command("CANCEL", "a/"), "a/b"));
  EXPECT_FALSE(after(frame("\1a", true) + frame("rest"), "a/b")) << "a message of two frames is no subscription";
  EXPECT_FALSE(after(frame("user message") + frame("") + command("OTHER", "x"), "a/b"));
  EXPECT_TRUE(after(frame("\1a"), "a/b"));
}

TEST_F(LocalPublisherTest, PeerThatBreaksTheProtocol_IsDisconnectedAndOthersAreNot) {
  const RawPeer good = subscriber("");
  for (const std::string& broken : std::vector<std::string>{
           "GET / HTTP/1.1\r\n\r\n", zmtp::greeting() + frame("no command"), zmtp::greeting() + ready("REQ"),
           zmtp::greeting() + command("READY", "damaged"), zmtp::greeting() + std::string(1, '\4') + "\xff" + std::string(255, 'x'),
           kOpening + frame("\1" + std::string(201, 'x')), kOpening + frame(std::string(600, 'x')), kOpening + std::string("\xf0\0", 2),
           kOpening + command("ERROR", "bye"), kOpening + std::string("\x02\xff\xff\xff\xff\xff\xff\xff\xff", 9)}) {
    const RawPeer bad(path_);
    static_cast<void>(bad.send(broken));
    turns(10);
    EXPECT_EQ(publisher_->peers(), 1U) << broken;
    EXPECT_FALSE(good.is_closed());
  }
  publish("a", event(1));
  EXPECT_EQ(good.received(), message("a", event(1)));
}

/// A greeting of ZMTP 3.1, whose peers may send subscriptions as commands.
TEST_F(LocalPublisherTest, NewerVersion_IsAnsweredWith3_0) {
  std::string newer = zmtp::greeting();
  newer[11] = 1;
  const RawPeer peer(path_);
  ASSERT_TRUE(peer.send(newer + ready("SUB") + command("SUBSCRIBE", "a") + command("SUBSCRIBE", "b") + command("CANCEL", "a")));
  EXPECT_TRUE(turns());
  EXPECT_EQ(peer.received(), kAnswer);
  publish("a", event(1));
  publish("b", event(2));
  EXPECT_EQ(peer.received(), message("b", event(2)));
}

TEST_F(LocalPublisherTest, OlderVersionOrOtherMechanism_GetsTheGreetingAndAClose) {
  std::string curve = zmtp::greeting();
  curve.replace(12, 5, "CURVE");
  const std::string version_2 = std::string("\xff\0\0\0\0\0\0\0\1\x7f", 10) + std::string("\1\2\0\0", 4);  // SUB, without identity
  const std::string version_1 = std::string("\1\0", 2) + std::string("\2\0\1", 3);                         // identity, a subscription
  for (const std::string& other : {version_2, version_1, curve}) {
    const RawPeer peer(path_);
    ASSERT_TRUE(peer.send(other));
    turns();
    EXPECT_EQ(peer.received(), kAnswer) << "its version shows the peer why";
    EXPECT_TRUE(peer.is_closed());
    EXPECT_EQ(publisher_->peers(), 0U);
  }
}

TEST_F(LocalPublisherTest, FloodOfSubscriptions_EndsThePeerAndOthersMissNothing) {
  const RawPeer good = subscriber("floor/");
  std::string flood = kOpening;
  for (std::size_t i = 0; i < LocalPublisher::kMostSubscriptions; ++i) flood += frame("\1" + std::to_string(i));
  const RawPeer flooder(path_);
  ASSERT_TRUE(flooder.send(flood));
  std::string expected;
  for (std::uint64_t scan = 0; scan < 20; ++scan) {
    turn();
    publish("floor/cop", event(scan));
    expected += message("floor/cop", event(scan));
  }
  EXPECT_EQ(publisher_->peers(), 2U) << "as many as allowed";
  EXPECT_EQ(said_.str(), "");
  ASSERT_TRUE(flooder.send(frame("\1one too many")));
  turns();
  EXPECT_EQ(publisher_->peers(), 1U);
  EXPECT_THAT(said_.str(), HasSubstr("a client of the data socket (process " + std::to_string(::getpid()) +
                                     ") was disconnected: a client may have 256 subscriptions of up to 200 bytes"));
  EXPECT_EQ(good.all_received(), expected);
}

TEST_F(LocalPublisherTest, SubscriberThatDoesNotRead_LosesWholeMessagesAndDelaysNobody) {
  RecordProperty("requirement", "PUB-4");
  const RawPeer stopped = subscriber("a");
  const RawPeer good = subscriber("a");
  dts::v1::StreamBlock sent = block_of_1_kb();
  std::string one;
  for (std::uint64_t sequence = 1001; sequence <= 2000; ++sequence) {  // all of the same length
    sent.set_sequence(sequence);
    publish("a", sent);
    turn();
    one = message("a", sent);
    ASSERT_EQ(good.received(), one) << sequence;
  }
  const std::uint64_t dropped = publisher_->dropped();
  EXPECT_GT(dropped, 100U);
  // It reads again: what was queued arrives whole, as much as was not dropped.
  std::string rest;
  for (int i = 0; i < 1000; ++i) {
    rest += stopped.all_received();
    turn();
  }
  EXPECT_EQ(rest.size(), one.size() * (1000U - dropped));
  sent.set_sequence(2001);
  publish("a", sent);
  EXPECT_EQ(stopped.received(), message("a", sent));
}

TEST_F(LocalPublisherTest, PeerThatDoesNotFinishItsHandshake_IsLeft) {
  const RawPeer good = subscriber("a");
  const RawPeer silent(path_);
  const RawPeer slow(path_);
  ASSERT_TRUE(slow.send(zmtp::greeting()));
  turns();
  EXPECT_EQ(publisher_->peers(), 3U);
  clock_.advance_ns(LocalPublisher::kHandshakeNs);
  turn();
  EXPECT_EQ(publisher_->peers(), 3U);
  clock_.advance_ns(1);
  turn();
  EXPECT_EQ(publisher_->peers(), 1U);
  clock_.advance_ns(100 * LocalPublisher::kHandshakeNs);
  turn();
  EXPECT_EQ(publisher_->peers(), 1U) << "an open connection has no time limit";
}

TEST_F(LocalPublisherTest, MoreConnectionsThanAProcessMayHave_AreClosedAndTheOthersServed) {
  const RawPeer good = subscriber("a");
  std::vector<RawPeer> many;
  for (std::size_t i = 0; i < LocalPublisher::kMostPeersOfAProcess + 10; ++i) {
    many.emplace_back(path_);
    turn();
  }
  turns();
  EXPECT_EQ(publisher_->peers(), LocalPublisher::kMostPeersOfAProcess);
  EXPECT_TRUE(many.back().is_closed());
  EXPECT_THAT(said_.str(), HasSubstr("the data socket rejects or ends connections: it serves 256, and 64 of one process"));
  publish("a", event(1));
  EXPECT_EQ(good.received(), message("a", event(1)));
  many.clear();
  EXPECT_TRUE(turn_until([&] { return publisher_->peers() == 1; }));
  const RawPeer later = subscriber("a");
}

/// Fills the socket of a peer that does not read, and its large queue up to the room for events, with blocks of 1 kB.
std::uint64_t fill(LocalPublisher& publisher, const std::function<void()>& turn) {
  const dts::v1::StreamBlock block = block_of_1_kb();
  std::uint64_t sent = 0;
  const std::uint64_t dropped = publisher.dropped();
  while (publisher.dropped() < dropped + 10) {
    publisher.send("floor/raw", block);
    static_cast<void>(publisher.flush(LocalPublisher::kMostPeers));
    turn();
    ++sent;
  }
  return sent;
}

TEST_F(LocalPublisherTest, SubscriberThatReadsTooSlowlyForEvents_GetsWhatWasQueuedAndIsDisconnected) {
  const RawPeer stopped = subscriber("");
  const std::uint64_t blocks = fill(*publisher_, [&] { turn(); });
  EXPECT_GT(blocks, 300U) << "352 kB and the kernel's buffer";
  std::uint64_t events = 0;
  const std::uint64_t dropped_blocks = publisher_->dropped();
  for (; publisher_->dropped() == dropped_blocks; ++events) {
    dts::v1::Event sent = event(events);
    sent.mutable_marker()->set_text(std::string(100, 'x'));
    publish("floor/marker", sent);
  }
  --events;
  EXPECT_GT(events, 200U) << "blocks leave room for events";
  publish("floor/marker", event(1));
  EXPECT_EQ(publisher_->dropped(), dropped_blocks + 2) << "nothing comes behind a missing event";

  std::string all;
  for (int i = 0; i < 1000 && publisher_->peers() > 0; ++i) {
    all += stopped.all_received();
    turn();
  }
  all += stopped.all_received();
  EXPECT_TRUE(stopped.is_closed());
  std::uint64_t complete = 0;
  std::span<const std::byte> bytes = std::as_bytes(std::span(all));
  while (!bytes.empty()) {
    const auto result = zmtp::next_frame(bytes, 1 << 20);
    const auto* frame_of_message = std::get_if<std::optional<zmtp::Frame>>(&result);
    ASSERT_TRUE(frame_of_message != nullptr && *frame_of_message) << "a frame was cut";
    bytes = bytes.subspan((*frame_of_message)->size);
    ++complete;
  }
  EXPECT_EQ(complete, 2 * (blocks - dropped_blocks + events));
  EXPECT_THAT(said_.str(), HasSubstr("was disconnected: it read too slowly, and an event found no room in its queue"));
}

TEST_F(LocalPublisherTest, SendAndFlush_DoNotAllocate) {
  publisher_->expect("floor/raw");
  std::vector<RawPeer> peers;
  for (const char* prefix : {"", "floor/", "floor/raw", "chair/"}) peers.push_back(subscriber(prefix));
  const RawPeer stopped = subscriber("floor/");
  dts::v1::StreamBlock block = block_of_1_kb();
  const auto send = [&](int count) {
    std::uint64_t calls = 0;
    for (int i = 0; i < count; ++i) {
      block.set_sequence(static_cast<std::uint64_t>(i));
      const std::uint64_t before = test::heap_calls_of_this_thread();
      publisher_->send("floor/raw", block);
      publisher_->send("floor/cop", block);
      static_cast<void>(publisher_->flush(LocalPublisher::kMostPeers));
      calls += test::heap_calls_of_this_thread() - before;
      for (const RawPeer& peer : peers) static_cast<void>(peer.received());
    }
    return calls;
  };
  send(1);  // meets floor/cop for the first time
  EXPECT_EQ(send(1000), 0U) << "also for a subscriber that does not read";
  EXPECT_GT(publisher_->dropped(), 0U);
  turn();
  EXPECT_EQ(send(1000), 0U) << "into its large queue";
}

/// As a rig's thread does that must not wait: `wait` runs outside the lock, everything else under it.
TEST_F(LocalPublisherTest, SendOnAnotherThread_NeedsNoLockWhileThePublishThreadWaits) {
  std::mutex mutex;
  std::atomic<std::uint64_t> sent{0};
  std::jthread publish_thread([&](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      publisher_->wait(bell_.fd(), 10);
      const std::lock_guard lock(mutex);
      static_cast<void>(publisher_->take_subscriptions());
    }
  });
  std::jthread rig([&](const std::stop_token& stop) {
    dts::v1::StreamBlock block = block_of_1_kb();
    while (!stop.stop_requested()) {
      const std::unique_lock lock(mutex, std::try_to_lock);
      if (!lock) continue;
      block.set_sequence(sent);
      publisher_->send("a", block);
      static_cast<void>(publisher_->flush(LocalPublisher::kMostPeers));
      ++sent;
      if (sent % 16 == 0) std::this_thread::yield();
    }
  });
  std::uint64_t messages = 0;
  for (int round = 0; round < 20; ++round) {
    const RawPeer reader(path_);
    const RawPeer stopped(path_);
    for (const RawPeer* peer : {&reader, &stopped}) EXPECT_TRUE(peer->send(kOpening + frame("\1a") + frame("\1b") + frame("\1a")));
    std::string bytes;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (bytes.size() < kAnswer.size() + 20'000 && std::chrono::steady_clock::now() < deadline) bytes += reader.received();
    EXPECT_EQ(bytes.substr(0, kAnswer.size()), kAnswer);
    messages += bytes.size() / 1000;
  }
  EXPECT_GE(messages, 20U * 20U);
}

// A subscriber that reads costs 0.01 MB at most, one that has stopped 0.4 MB.
static_assert(LocalPublisher::kSmallQueueBytes < 10'000 && LocalPublisher::kQueueBytes < 400'000);

TEST_F(LocalPublisherTest, LargeQueues_AreFewAndEndWhenTheSubscriberHasRead) {
  const auto queued = [&](const std::vector<RawPeer>& peers) {
    fill(*publisher_, [&] { turns(4); });
    std::size_t bytes = 0;
    for (int i = 0; i < 200; ++i) {
      for (const RawPeer& peer : peers) bytes += peer.all_received().size();
      turns(4);
    }
    return bytes;
  };
  std::vector<RawPeer> peers;
  peers.push_back(subscriber("floor/"));
  const std::size_t of_one = queued(peers);
  EXPECT_GT(of_one, LocalPublisher::kQueueBytes - LocalPublisher::kQueueBytes / 8);
  while (peers.size() < LocalPublisher::kMostLargeQueuesOfAProcess + 4) peers.push_back(subscriber("floor/"));
  const dts::v1::StreamBlock block = block_of_1_kb();
  for (int i = 0; i < 1000; ++i) {
    publisher_->send("floor/raw", block);
    static_cast<void>(publisher_->flush(LocalPublisher::kMostPeers));
    turns(4);
  }
  std::size_t large = 0;
  for (const RawPeer& peer : peers) {
    std::size_t bytes = 0;
    for (int i = 0; i < 50; ++i) {
      bytes += peer.all_received().size();
      turns(4);
    }
    if (bytes > of_one - 4096) ++large;
  }
  EXPECT_EQ(large, LocalPublisher::kMostLargeQueuesOfAProcess);
  EXPECT_GT(queued(peers), LocalPublisher::kQueueBytes) << "the memory was given back";
}

/// Connects from a process of its own and keeps the connections until it is ended.
class OtherProcess {
 public:
  OtherProcess(const std::string& path, std::size_t connections, const std::string& bytes) : pid_(::fork()) {
    if (pid_ != 0) return;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    for (std::size_t i = 0; i < connections; ++i) {
      const int fd = ::socket(AF_UNIX, SOCK_STREAM, 0);
      if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) ::_exit(1);
      static_cast<void>(::send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL));
    }
    while (true) ::pause();
  }
  ~OtherProcess() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  OtherProcess(const OtherProcess&) = delete;
  OtherProcess& operator=(const OtherProcess&) = delete;

 private:
  pid_t pid_;
};

TEST_F(LocalPublisherTest, FewProcessesWithAllConnections_LockNobodyOut) {
  for (const bool subscribe : {false, true}) {
    const std::string bytes = kOpening + (subscribe ? frame("\1nothing") : "");
    std::vector<std::unique_ptr<OtherProcess>> others;
    while (others.size() * LocalPublisher::kMostPeersOfAProcess < LocalPublisher::kMostPeers) {
      others.push_back(std::make_unique<OtherProcess>(path_, LocalPublisher::kMostPeersOfAProcess, bytes));
    }
    ASSERT_TRUE(turn_until([&] { return publisher_->peers() == LocalPublisher::kMostPeers; }));
    turns(500);  // their handshakes
    const RawPeer good = subscriber("a");
    publish("a", event(1));
    EXPECT_EQ(good.received(), message("a", event(1)));
    EXPECT_EQ(publisher_->peers(), LocalPublisher::kMostPeers) << "one of the others has ended";
    others.clear();
    ASSERT_TRUE(turn_until([&] { return publisher_->peers() == 1; }));
  }
}

TEST_F(LocalPublisherTest, NewcomerWithoutAFreeConnection_ReplacesOneThatNeverSubscribed) {
  std::vector<std::unique_ptr<OtherProcess>> others;
  while (others.size() < LocalPublisher::kMostPeers) {
    const bool is_idle = others.size() == 100;
    others.push_back(std::make_unique<OtherProcess>(path_, 1, kOpening + (is_idle ? "" : frame("\1nothing"))));
    ASSERT_TRUE(turn_until([&] { return publisher_->peers() == others.size(); }));
  }
  turns(500);
  EXPECT_TRUE(RawPeer(path_).send(kOpening));
  turns();
  EXPECT_EQ(publisher_->peers(), LocalPublisher::kMostPeers) << "everybody has one connection, and had no time yet";
  clock_.advance_ns(LocalPublisher::kHandshakeNs + 1);
  const RawPeer good = subscriber("a");
  publish("a", event(1));
  EXPECT_EQ(good.received(), message("a", event(1)));
}

/// No new descriptors while this exists.
class WithoutFreeDescriptors {
 public:
  WithoutFreeDescriptors() {
    EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before_), 0);
    rlimit none = before_;
    none.rlim_cur = 0;
    EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  }
  ~WithoutFreeDescriptors() { EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &before_), 0); }
  WithoutFreeDescriptors(const WithoutFreeDescriptors&) = delete;
  WithoutFreeDescriptors& operator=(const WithoutFreeDescriptors&) = delete;

 private:
  rlimit before_{};
};

TEST_F(LocalPublisherTest, NewcomerWithoutAFreeDescriptor_IsAcceptedWhenOneIsFreeAgain) {
  const RawPeer peer(path_);
  ASSERT_TRUE(peer.send(kOpening + frame("\1a")));
  {
    const WithoutFreeDescriptors none;
    turns();
    clock_.advance_ns(LocalPublisher::kAcceptPauseNs);
    turns();
  }
  EXPECT_EQ(publisher_->peers(), 0U);
  turns();
  EXPECT_EQ(publisher_->peers(), 0U) << "it does not try all the time";
  clock_.advance_ns(LocalPublisher::kAcceptPauseNs);
  turns();
  EXPECT_EQ(publisher_->peers(), 1U) << "although no other client has left";
  publish("a", event(1));
  EXPECT_EQ(peer.received(), kAnswer + message("a", event(1)));
  const std::string said = said_.str();
  EXPECT_THAT(said, HasSubstr("the data socket cannot accept a client: no file descriptor is free"));
  EXPECT_EQ(said.find("cannot accept"), said.rfind("cannot accept")) << "once is enough";
}

TEST_F(LocalPublisherTest, AddressInUse_IsRefusedAndALeftOverFileIsReplaced) {
  const auto second = LocalPublisher::bind("ipc://" + path_, clock_, log_);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::WrongState);
  publisher_.reset();
  publisher_ = LocalPublisher::bind("ipc://" + path_, clock_, log_).value();
  const RawPeer peer = subscriber("a");
  EXPECT_FALSE(LocalPublisher::bind("tcp://0.0.0.0:5555", clock_, log_));
  const auto nowhere = LocalPublisher::bind("ipc:///nonexistent-folder/data", clock_, log_);
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().what, HasSubstr("data socket ipc:///nonexistent-folder/data cannot be bound"));
}

TEST_F(LocalPublisherTest, Bell_EndsTheWait) {
  bell_.ring();
  publisher_->wait(bell_.fd(), 60'000);
  EXPECT_FALSE(publisher_->take_subscriptions());
  bell_.clear();
}

}  // namespace
}  // namespace dts::ipc
