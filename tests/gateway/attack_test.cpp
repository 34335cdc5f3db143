// SPDX-License-Identifier: Apache-2.0
// Clients that mean it ill, against the real gateway, while somebody measures: the gateway stays small and serves on, the daemon loses
// nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <list>

#include "dts/v1/gateway.pb.h"
#include "gateway/gateway_process.h"
#include "gateway/raw_client.h"
#include "support/sanitized.h"

namespace dts::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

/// What an attack may make the gateway keep: buffers of its 64 connections and what the heap does not give back.
constexpr long kMostGrowth_kb = 8 * 1024;

std::string subscribe_to(const std::string& prefix) {
  v1::FromBrowser message;
  message.mutable_subscribe()->add_topics(prefix);
  message.mutable_subscribe()->set_frames_per_second(120);
  return frame(kFin | kBinary, message.SerializeAsString());
}

/// A tab that behaves: paints what it is sent.
class HonestTab {
 public:
  explicit HonestTab(std::uint16_t port) : client_(open_websocket(port)) {
    if (client_) client_->send(subscribe_to(""));
  }

  [[nodiscard]] bool is_open() const noexcept { return client_.has_value(); }
  /// The next frame of live data, painted at once.
  [[nodiscard]] bool paints_a_frame() {
    while (auto got = read_frame(*client_)) {
      v1::FromGateway message;
      if (got->opcode == kPing) client_->send(frame(kFin | kPong, got->payload));
      if (got->opcode != kBinary || !message.ParseFromString(got->payload) || !message.has_frame()) continue;
      v1::FromBrowser painted;
      painted.mutable_painted()->set_frame(message.frame().number());
      client_->send(frame(kFin | kBinary, painted.SerializeAsString()));
      return true;
    }
    return false;
  }

 private:
  std::optional<RawClient> client_;
};

class GatewayAttack : public testing::Test {
 protected:
  GatewayAttack() : gateway_(daemon_, {"--local-role", "operator"}), honest_(gateway_.port()) {}

  void SetUp() override {
    ASSERT_TRUE(daemon_.is_ready()) << daemon_.log();
    ASSERT_NE(gateway_.port(), 0) << gateway_.log();
    ASSERT_TRUE(honest_.is_open());
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(honest_.paints_a_frame());
    before_kb_ = resident_kb(gateway_.pid());
  }

  void TearDown() override {
    if (before_kb_ == 0) return;
    const long after_kb = resident_kb(gateway_.pid());
    EXPECT_TRUE(honest_.paints_a_frame()) << "the honest tab was hurt";
    EXPECT_TRUE(eventually([&] { return status_of(answer_to("GET /")) == "200"; })) << "new tabs are not served";
    const auto count = watch_.stop();
    std::cout << "gateway " << before_kb_ << " kB before, " << most_kb_ << " kB at most, " << after_kb << " kB after; daemon "
              << count.scans << " scans, " << count.lost << " lost, " << count.gaps << " gaps\n";
    EXPECT_TRUE(gateway_.is_running()) << gateway_.log();
    EXPECT_EQ(gateway_.stop(), 0) << "with a tab open: " << gateway_.log();
    EXPECT_GT(count.scans, 0U);
    EXPECT_EQ(count.lost, 0U);
    EXPECT_EQ(count.gaps, 0U);
    if (!kIsSanitized) {
      EXPECT_LT(std::max(most_kb_, after_kb) - before_kb_, kMostGrowth_kb);
    }
  }

  [[nodiscard]] std::string answer_to(const std::string& first_words, const std::string& headers = {}) const {
    RawClient client(gateway_.port());
    client.send(request(gateway_.port(), first_words, headers));
    return client.read_answer();
  }
  void measure() { most_kb_ = std::max(most_kb_, resident_kb(gateway_.pid())); }
  [[nodiscard]] std::uint16_t port() const noexcept { return gateway_.port(); }

  DaemonProcess daemon_;
  ScanWatch watch_{daemon_};
  GatewayProcess gateway_;
  HonestTab honest_;
  long before_kb_ = 0;
  long most_kb_ = 0;
};

TEST_F(GatewayAttack, FiveHundredConnections_MostAreClosedAtOnce) {
  std::list<RawClient> crowd;
  for (int i = 0; i < 500; ++i) {
    crowd.emplace_back(port());
    crowd.back().send("GET / HTTP/1.1\r\n");
  }

  const auto closed = [&crowd] {
    return std::ranges::count_if(crowd, [](RawClient& client) { return client.is_closed_within(milliseconds(1)); });
  };
  EXPECT_TRUE(eventually([&] { return closed() >= 500 - 64; })) << closed();
  measure();

  EXPECT_TRUE(honest_.paints_a_frame());
  // Not by the time that a request may take, which ends all of them.
  crowd.clear();
  const auto refused = [this] {
    const std::string page = answer_to("GET /metrics");
    const std::string name = "\ndts_gateway_refused_connections_total ";
    const std::size_t at = page.find(name);
    return at == std::string::npos ? 0.0 : std::stod(page.substr(at + name.size()));
  };
  EXPECT_TRUE(eventually([&] { return refused() >= 500 - 64; })) << refused();
}

TEST_F(GatewayAttack, TwoHundredSlowLoris_AreEndedWhileTheySend) {
  std::list<RawClient> crowd;
  for (int i = 0; i < 200; ++i) {
    crowd.emplace_back(port());
    crowd.back().send("GET / HTTP/1.1\r\nX-Slow: ");
  }

  const auto deadline = Clock::now() + kPatience;
  while (!crowd.empty() && Clock::now() < deadline) {
    std::erase_if(crowd, [](RawClient& client) { return !client.send("a") || client.is_closed_within(milliseconds(1)); });
    measure();
  }

  EXPECT_TRUE(crowd.empty());
}

/// Says the same small frame again and again, as fast as the gateway takes it.
struct Flood {
  RawClient client;
  std::string small_frame;
  std::size_t sent_bytes = 0;

  /// False: the gateway has ended it.
  [[nodiscard]] bool goes_on() {
    std::string many;
    while (many.size() < 60000) many += small_frame;
    const std::size_t begun = sent_bytes % small_frame.size();
    const auto sent = ::send(client.socket(), many.data() + begun, many.size() - begun, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent > 0) sent_bytes += static_cast<std::size_t>(sent);
    return (sent > 0 || errno == EAGAIN) && !client.is_closed_within(milliseconds(1));
  }
};

TEST_F(GatewayAttack, EndlessFragmentsAndPings_AreEnded) {
  std::list<Flood> floods;
  for (int i = 0; i < 20; ++i) {
    auto client = open_websocket(port());
    ASSERT_TRUE(client.has_value());
    client->send(frame(kBinary, ""));
    floods.push_back({.client = std::move(*client), .small_frame = i % 2 == 0 ? frame(kContinuation, "") : frame(kFin | kPing, "ping")});
  }

  const auto deadline = Clock::now() + kPatience;
  std::size_t ended_for_policy = 0;
  while (!floods.empty() && Clock::now() < deadline) {
    for (auto flood = floods.begin(); flood != floods.end();) {
      if (flood->goes_on()) {
        ++flood;
        continue;
      }
      ended_for_policy += read_close_code(flood->client) == 1008 ? 1U : 0U;
      flood = floods.erase(flood);
    }
    measure();
  }

  EXPECT_TRUE(floods.empty());
  EXPECT_EQ(ended_for_policy, 20U);
}

TEST_F(GatewayAttack, TabsThatNeverRead_CostLittle) {
  std::list<RawClient> crowd;
  for (int i = 0; i < 30; ++i) {
    auto client = open_websocket(port(), {}, 4096);
    ASSERT_TRUE(client.has_value());
    client->send(subscribe_to(""));
    crowd.push_back(std::move(*client));
  }

  v1::FromBrowser probe;
  probe.mutable_clock_probe()->set_browser_ms(1.0);
  std::string many;
  for (int i = 0; i < 50; ++i) many += frame(kFin | kBinary, probe.SerializeAsString());
  for (int round = 0; round < 60; ++round) {
    for (RawClient& client : crowd) ::send(client.socket(), many.data(), many.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    ASSERT_TRUE(honest_.paints_a_frame());
    measure();
  }
}

}  // namespace
}  // namespace dts::test
