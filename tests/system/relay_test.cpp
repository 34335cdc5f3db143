// SPDX-License-Identifier: Apache-2.0
// dts-relay between the real daemon and clients with keys: what ends one of the two does not end the other. The relay is killed three
// times, or every 5 s for DTS_RELAY_KILL_SECONDS.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "system/networked_daemon.h"

namespace dts::test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;

struct Kills {
  int count = 3;
  std::chrono::seconds pause{0};
};

Kills wanted_kills() {
  const char* wanted = std::getenv("DTS_RELAY_KILL_SECONDS");
  constexpr int kPauseSeconds = 5;
  return wanted == nullptr ? Kills{} : Kills{std::atoi(wanted) / kPauseSeconds, std::chrono::seconds(kPauseSeconds)};
}

class RelayTest : public NetworkedDaemon {
 protected:
  static client::Subscriber subscribed(const client::Key& key) {
    return client::Subscriber::open({.endpoint = key.data, .topics = {"floor/cop"}, .key = key}).value();
  }
  static client::ControlClient commanding(const client::Key& key, milliseconds timeout = kPatience) {
    return client::ControlClient::open({.endpoint = key.control, .timeout = timeout, .key = key}).value();
  }
  /// Returns the scans lost before the next block that was sampled at `scan` or later; nothing if none comes.
  static std::optional<std::uint64_t> lost_until(client::Subscriber& subscriber, std::uint64_t scan) {
    const auto patience_ends = std::chrono::steady_clock::now() + kPatience;
    std::uint64_t lost = 0;
    while (std::chrono::steady_clock::now() < patience_ends) {
      const auto message = subscriber.receive(milliseconds(200)).value();
      const auto* block = message ? std::get_if<client::Block>(&*message) : nullptr;
      if (block == nullptr) continue;
      lost += block->lost_scans;
      if (block->first_scan >= scan) return lost;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::uint64_t scans() const { return daemon_.control().status()->rigs(0).scans_total(); }
};

TEST_F(RelayTest, KilledInASession_CostsNoScan_AndItsClientsComeBack) {
  RecordProperty("requirement", "SEC-4");
  const client::Key eve = key("eve", "viewer");
  client::ControlClient mate = commanding(key("otto", "operator"));
  client::Subscriber local = daemon_.subscribe({"floor/cop"});
  client::Subscriber remote = subscribed(eve);
  v1::StartSessionRequest start;
  start.set_rig("floor");
  start.set_protocol("free");
  const auto session = mate.start_session(start);
  ASSERT_TRUE(session) << session.error().what;
  ASSERT_EQ(lost_until(local, scans()), 0U);
  ASSERT_EQ(lost_until(remote, scans()), 0U);

  const Kills kills = wanted_kills();
  ASSERT_GT(kills.count, 0);
  std::uint64_t missed_total = 0;
  for (int death = 0; death < kills.count; ++death) {
    std::this_thread::sleep_for(kills.pause);
    EXPECT_EQ(relay_.end(SIGKILL), 128 + SIGKILL);
    const std::uint64_t killed_at = scans();
    EXPECT_EQ(lost_until(local, killed_at + 50), 0U) << "sampling goes on without it";
    relay_.start();
    ASSERT_TRUE(relay_.is_ready()) << relay_.log();
    const auto missed = lost_until(remote, scans());
    ASSERT_TRUE(missed) << "the subscriber resumes by itself";
    EXPECT_GT(*missed, 0U) << "and knows what it has missed";
    missed_total += *missed;
    EXPECT_EQ(lost_until(local, scans()), 0U);
  }

  ASSERT_TRUE(mate.stop_session("floor")) << "as do those who send commands";
  const Finished shown = daemon_.ctl({"session", "show", session->session_id(), "--json"});
  EXPECT_EQ(nlohmann::json::parse(shown.out).at("lost_scans"), 0) << shown.out;
  std::cout << "relay killed " << kills.count << " times: dts-relay's client missed " << missed_total << " scans and knows it\n";
  EXPECT_EQ(daemon_.ctl({"session", "verify", session->session_id()}).status, 0);
  EXPECT_THAT(daemon_.ctl({"audit"}).out, HasSubstr("key:otto"));
}

TEST_F(RelayTest, DaemonIsAway_IsSaidToRemoteClients_UntilItIsBack) {
  const client::Key otto = key("otto", "operator");
  client::Subscriber remote = subscribed(otto);
  ASSERT_TRUE(lost_until(remote, 1));
  ASSERT_TRUE(commanding(otto).status());

  daemon_.signal(SIGKILL);
  static_cast<void>(daemon_.wait());
  client::Error error;
  ASSERT_TRUE(eventually([&] {
    const auto status = commanding(otto, milliseconds(500)).status();
    if (!status) error = status.error();
    return !status && error.what == "dts-relay answers, but dtsd does not";
  }));
  EXPECT_EQ(error.code, client::ErrorCode::Unreachable);

  daemon_.restart();
  ASSERT_TRUE(daemon_.is_ready());
  EXPECT_TRUE(eventually([&] { return commanding(otto, milliseconds(500)).status().has_value(); }));
  EXPECT_TRUE(lost_until(remote, 1));
}

TEST_F(RelayTest, NewKey_IsWelcomeAtOnce) {
  for (int number = 0; number < 10; ++number) {
    const client::Key fresh = key("k" + std::to_string(number), "viewer");
    EXPECT_TRUE(commanding(fresh, milliseconds(5000)).status()) << relay_.log();
  }
}

TEST_F(RelayTest, AddressInUse_IsAFailureWithTheReason) {
  const Finished second = run_program({DTS_RELAY_PROGRAM, "--config", daemon_.config_file()}, daemon_.environment());

  EXPECT_EQ(second.status, 1);
  EXPECT_THAT(second.err, HasSubstr("another program listens there"));
}

TEST(Relay, WithoutWhatItNeeds_EndsWithAReason) {
  const DaemonProcess daemon;
  const auto relay = [&](const std::string& file, const std::string& state) {
    return run_program({DTS_RELAY_PROGRAM, "--config", file},
                       {"DTSD_RUNTIME_DIR=" + daemon.directory().string(), "DTSD_STATE_DIR=" + state});
  };
  const Finished unneeded = relay(daemon.config_file(), daemon.state_directory());
  EXPECT_EQ(unneeded.status, 0);
  EXPECT_THAT(unneeded.err, HasSubstr("has no [network]"));

  const std::string file = (daemon.directory() / "other.toml").string();
  std::ofstream(file) << "[network]\ncontrol = \"tcp://127.0.0.1:1\"\ndata = \"tcp://127.0.0.1:2\"\n";
  const Finished early = relay(file, daemon.directory() / "nothing");
  EXPECT_EQ(early.status, 5);
  EXPECT_THAT(early.err, HasSubstr("start dtsd first"));

  std::ofstream(file) << "[network]\ncontrol = \"tcp://127.0.0.1:x\"\n";
  const Finished wrong = relay(file, daemon.state_directory());
  EXPECT_EQ(wrong.status, 2);
  EXPECT_THAT(wrong.err, HasSubstr("other.toml:2:11: 'tcp://127.0.0.1:x': the port must be 1..65535"));
  EXPECT_EQ(run_program({DTS_RELAY_PROGRAM}).status, 2);
}

}  // namespace
}  // namespace dts::test
