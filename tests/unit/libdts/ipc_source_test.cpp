// SPDX-License-Identifier: Apache-2.0
// The reader of local data sockets against peers that a test scripts byte by byte. What libzmq does as a peer: subscriber_test.cpp.
#include "../clients/libdts/ipc_source.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <string>
#include <thread>
#include <vector>

#include "unit/libdts/fake_daemon.h"

namespace dts::client {
namespace {

using namespace std::chrono_literals;
using testing::kDeadline;

std::string frame(const std::string& body, bool has_more = false) {
  std::string bytes;
  zmtp::append_frame(bytes, body, has_more);
  return bytes;
}
std::string message(const std::string& topic, const std::string& body) { return frame(topic, true) + frame(body); }
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

/// A listening socket; each connection is served by the test.
class ScriptedPeer {
 public:
  explicit ScriptedPeer(const std::filesystem::path& path) : listener_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.string().copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    EXPECT_EQ(::listen(listener_, 4), 0);
  }
  ~ScriptedPeer() {
    hang_up();
    ::close(listener_);
  }
  ScriptedPeer(const ScriptedPeer&) = delete;
  ScriptedPeer& operator=(const ScriptedPeer&) = delete;

  void answer() { connection_ = ::accept(listener_, nullptr, nullptr); }
  void send(const std::string& bytes) const {
    EXPECT_EQ(::send(connection_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
  }
  /// Waits for exactly these bytes.
  void expect(const std::string& bytes) const {
    std::string got(bytes.size(), '\0');
    std::size_t size = 0;
    while (size < got.size()) {
      const ssize_t more = ::recv(connection_, got.data() + size, got.size() - size, 0);
      if (more <= 0) break;
      size += static_cast<std::size_t>(more);
    }
    EXPECT_EQ(got.substr(0, size), bytes);
  }
  void wait_until_left() const {
    std::array<char, 256> ignored{};
    while (::recv(connection_, ignored.data(), ignored.size(), 0) > 0) {
    }
  }
  void hang_up() {
    if (connection_ >= 0) ::close(connection_);
    connection_ = -1;
  }
  /// Greeting and READY in both directions, as a publisher.
  void shake_hands() {
    answer();
    send(zmtp::greeting() + ready("XPUB"));
    expect(zmtp::greeting() + ready("SUB"));
  }

 private:
  int listener_;
  int connection_ = -1;
};

class IpcSourceTest : public ::testing::Test {
 protected:
  std::unique_ptr<IpcSource> open(std::size_t largest_message = 1000) {
    return std::move(*IpcSource::open({.endpoint = directory_.endpoint("data.sock"), .largest_message = largest_message}));
  }
  /// The next message within the deadline as "topic=body", or "malformed".
  static std::string next(IpcSource& source) {
    const auto deadline = std::chrono::steady_clock::now() + kDeadline;
    while (std::chrono::steady_clock::now() < deadline) {
      if (const auto got = source.take()) {
        if (!got->is_well_formed) return "malformed";
        return std::string(got->topic) + "=" + std::string(reinterpret_cast<const char*>(got->body.data()), got->body.size());
      }
      std::ignore = source.wait(10ms);
    }
    return "nothing";
  }

  testing::TemporaryDirectory directory_;
  ScriptedPeer peer_{directory_.path() / "data.sock"};
};

TEST_F(IpcSourceTest, Messages_ArriveHoweverTheBytesAreCut) {
  std::string all = zmtp::greeting() + ready("XPUB") + message("a", "1") + command("UNKNOWN", "x") + message("b", std::string(300, 'y')) +
                    message("", "");
  for (const std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{64}, all.size()}) {
    std::jthread server([&] {
      peer_.answer();
      for (std::size_t sent = 0; sent < all.size(); sent += piece) peer_.send(all.substr(sent, piece));
    });
    const auto source = open();
    EXPECT_EQ(next(*source), "a=1") << piece;
    EXPECT_EQ(next(*source), "b=" + std::string(300, 'y')) << piece;
    EXPECT_EQ(next(*source), "=") << piece;
    server.join();
    peer_.hang_up();
  }
}

TEST_F(IpcSourceTest, Subscriptions_AreCountedAndSentAtOnceOrAfterTheHandshake) {
  std::jthread server([&] { peer_.shake_hands(); });
  const auto source = open();
  server.join();
  source->subscribe("a");
  source->subscribe("b");
  source->subscribe("a");
  source->unsubscribe("a");
  source->unsubscribe("never subscribed");
  source->unsubscribe("b");
  peer_.expect(frame("\1a") + frame("\1b") + frame(std::string("\0b", 2)));
  EXPECT_EQ(source->interruptions(), 0U);
  peer_.hang_up();
  std::jthread again([&] {
    peer_.shake_hands();
    peer_.expect(frame("\1a"));
    peer_.send(message("a", "after the restart"));
  });
  EXPECT_EQ(next(*source), "a=after the restart");
  EXPECT_EQ(source->interruptions(), 1U);
}

TEST_F(IpcSourceTest, Ping_IsAnsweredWhileMessagesFlow) {
  std::jthread server([&] {
    peer_.shake_hands();
    peer_.send(command("PING", std::string("\0\x0a", 2) + "now") + message("a", "1"));
    peer_.expect(command("PONG", "now"));
  });
  const auto source = open();
  EXPECT_EQ(next(*source), "a=1");
}

TEST_F(IpcSourceTest, MessagesOfOneOrManyFrames_AreMalformedAndTheNextArrives) {
  std::jthread server([&] {
    peer_.shake_hands();
    std::string many;
    for (int i = 0; i < 1000; ++i) many += frame(std::string(900, 'x'), true);
    peer_.send(frame("alone") + message("a", "1"));
    peer_.send(many + frame("last") + message("b", "2"));
  });
  const auto source = open();
  for (const char* expected : {"malformed", "a=1", "malformed", "b=2"}) EXPECT_EQ(next(*source), expected);
}

TEST_F(IpcSourceTest, PeerThatBreaksTheProtocol_IsLeftAndTheNextConnectionWorks) {
  const std::string open_connection = zmtp::greeting() + ready("PUB");
  for (const std::string& broken : std::vector<std::string>{
           "HTTP/1.1 400 Bad Request\r\n\r\n", zmtp::greeting() + frame("a message instead of READY"), zmtp::greeting() + ready("ROUTER"),
           zmtp::greeting() + command("READY", "damaged"), open_connection + frame(std::string(1001, 'x')),
           open_connection + frame("topic", true) + frame(std::string(1001, 'x')), open_connection + std::string("\xf8\x00", 2),
           open_connection + command("ERROR", "go"), open_connection + frame("topic", true) + command("PING", "xxx"),
           open_connection + std::string("\x02\xff\xff\xff\xff\xff\xff\xff\xff", 9)}) {
    std::jthread server([&] {
      peer_.answer();
      peer_.send(broken);
      peer_.wait_until_left();
      peer_.hang_up();
      peer_.shake_hands();
      peer_.send(message("a", "1"));
    });
    const auto source = open();
    EXPECT_EQ(next(*source), "malformed") << broken;
    EXPECT_EQ(next(*source), "a=1") << broken;
    server.join();
    peer_.hang_up();
  }
}

TEST_F(IpcSourceTest, NobodyThere_IsNoErrorAndTakesNoLongerThanAsked) {
  const auto source = std::move(*IpcSource::open({.endpoint = directory_.endpoint("absent.sock"), .largest_message = 1000}));
  EXPECT_FALSE(source->take());
  EXPECT_EQ(source->wait(0ms), Waited::TimedOut);
  ScriptedPeer late(directory_.path() / "absent.sock");
  std::jthread server([&] {
    late.shake_hands();
    late.send(message("a", "1"));
  });
  EXPECT_EQ(next(*source), "a=1");
}

TEST(IpcSource, AddressThatIsNoSocketName_IsRefused) {
  for (const std::string& path : {std::string(), std::string(200, 'x'), std::string("a\0b", 3)}) {
    const auto refused = IpcSource::open({.endpoint = "ipc://" + path, .largest_message = 1000});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::InvalidArgument);
  }
}

TEST(IpcSource, AbstractAddress_IsConnectedLikeLibzmqDoes) {
  const std::string endpoint = "ipc://@dts-test-" + std::to_string(::getpid());
  testing::FakePublisher daemon(endpoint);
  const auto source = std::move(*IpcSource::open({.endpoint = endpoint, .largest_message = 1000}));
  source->subscribe("a");
  ASSERT_TRUE(daemon.wait_for_subscription("a"));
  daemon.send_raw({"a", "1"});
  EXPECT_EQ(source->wait(kDeadline), Waited::Ready);
  EXPECT_EQ(source->take()->topic, "a");
}

}  // namespace
}  // namespace dts::client
