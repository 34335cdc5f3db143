// SPDX-License-Identifier: Apache-2.0
// Clients on other machines: CURVE over TCP between the real programs, roles, revocation, reload.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "system/networked_daemon.h"

namespace dts::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr int kOk = 0;
constexpr int kUnreachable = 3;
constexpr int kNotAllowed = 4;

class KeysTest : public NetworkedDaemon {
 protected:
  /// dtsctl as on another machine: it knows the key file and nothing else. A refusal is noticed by the timeout alone.
  static Finished remote(const std::string& key, std::vector<std::string> words, const std::string& timeout_s = "60") {
    words.insert(words.begin(), {DTSCTL_PROGRAM, "--key", key, "--timeout", timeout_s});
    return run_program(words, {"DTSD_RUNTIME_DIR=/nonexistent"});
  }

  [[nodiscard]] std::string audit() const { return daemon_.ctl({"audit", "--json"}).out; }
  [[nodiscard]] std::string key_folder() const { return (daemon_.state_directory() / "keys").string(); }
};

TEST_F(KeysTest, EachRole_MayWhatItMayAndNoMore) {
  RecordProperty("requirement", "SEC-1");
  const std::string viewer = new_key("eve", "viewer");
  const std::string mate = new_key("otto", "operator");
  const std::string engineer = new_key("ina", "engineer");

  EXPECT_EQ(remote(viewer, {"status"}).status, kOk);
  EXPECT_EQ(remote(viewer, {"watch", "floor/cop", "--count", "3", "--jsonl"}).status, kOk);
  const Finished refused = remote(viewer, {"session", "start", "--rig", "floor", "--protocol", "free"});
  EXPECT_EQ(refused.status, kNotAllowed);
  EXPECT_THAT(refused.err, HasSubstr("needs the role operator; key:eve has viewer"));
  EXPECT_EQ(remote(mate, {"mark", "hello"}).status, kOk);
  EXPECT_EQ(remote(mate, {"key", "list"}).status, kNotAllowed);
  EXPECT_EQ(remote(engineer, {"key", "list"}).status, kOk);
  EXPECT_THAT(audit(), HasSubstr("key:otto"));
  EXPECT_THAT(audit(), HasSubstr("not_allowed"));
}

TEST_F(KeysTest, WithoutAKeyOfItsOwn_NobodyGetsIn) {
  RecordProperty("requirement", "SEC-2");
  const std::string good = new_key("eve", "viewer");
  EXPECT_EQ(run_program({DTSCTL_PROGRAM, "--endpoint", address_of(control_), "--timeout", "1", "status"}).status, kUnreachable);

  // The name of a good key over another pair: what counts is the secret.
  const auto other = client::new_key("eve");
  ASSERT_TRUE(other);
  const auto known = client::read_key(good);
  ASSERT_TRUE(known);
  client::Key forged = *known;
  forged.public_key = other->public_key;
  forged.secret_key = other->secret_key;
  const std::string bad = (daemon_.directory() / "forged.key").string();
  ASSERT_TRUE(client::write_new_key(bad, forged));
  const Finished refused = remote(bad, {"status"}, "2");
  EXPECT_EQ(refused.status, kUnreachable);
  EXPECT_THAT(refused.err, HasSubstr("that it has the key 'eve'"));
}

TEST_F(KeysTest, Revoked_LosesItsRunningSubscription_OthersComeBack) {
  RecordProperty("requirement", "SEC-2");
  const client::Key eve = key("eve", "viewer");
  const client::Key otto = key("otto", "operator");
  const auto subscribed = [](const client::Key& key) {
    return client::Subscriber::open({.endpoint = key.data, .topics = {"floor/cop"}, .key = key}).value();
  };
  client::Subscriber watching = subscribed(eve);
  client::Subscriber other = subscribed(otto);
  const auto hears = [](client::Subscriber& subscriber) { return subscriber.receive(std::chrono::milliseconds(200)).value().has_value(); };
  ASSERT_TRUE(eventually([&] { return hears(watching); }));
  ASSERT_TRUE(eventually([&] { return hears(other); }));

  ASSERT_EQ(daemon_.ctl({"key", "revoke", "eve"}).status, kOk);
  const std::uint64_t scans_at_revoke = daemon_.control().status()->rigs(0).scans_total();

  EXPECT_TRUE(eventually([&] { return !hears(watching) && !hears(watching) && !hears(watching); }));
  // What it still had in its queue does not count: it must hear what was sampled two seconds later.
  EXPECT_TRUE(eventually([&] {
    const auto message = other.receive(std::chrono::milliseconds(200)).value();
    const auto* block = message ? std::get_if<client::Block>(&*message) : nullptr;
    return block != nullptr && block->first_scan > scans_at_revoke + 200;
  }));
  EXPECT_EQ(remote((daemon_.directory() / "eve.key").string(), {"status"}, "2").status, kUnreachable);
}

TEST_F(KeysTest, Hangup_ReadsTheKeysAgain_AndNoSecretIsLogged) {
  const std::string key = new_key("eve", "viewer");
  const std::string hidden_half = client::read_key(key).value().secret_key;
  ASSERT_EQ(remote(key, {"status"}).status, kOk);
  std::ofstream(key_folder() + "/clients.toml") << "# nobody\n";

  daemon_.signal(SIGHUP);

  EXPECT_TRUE(eventually([&] { return remote(key, {"status"}, "2").status == kUnreachable; }));
  EXPECT_THAT(daemon_.log(), HasSubstr("SIGHUP: 0 client key(s)"));
  std::ofstream(key_folder() + "/clients.toml") << "[[client]\n";
  daemon_.signal(SIGHUP);
  EXPECT_TRUE(eventually([&] { return daemon_.log().find("clients.toml:1:") != std::string::npos; }));
  EXPECT_TRUE(daemon_.is_running());

  std::ifstream file(key_folder() + "/server.toml");
  const std::string server((std::istreambuf_iterator<char>(file)), {});
  const std::string secret = server.substr(server.find("secret_key = \"") + 14, 40);
  EXPECT_EQ(secret.size(), 40U);
  for (const std::string& hidden : {secret, hidden_half}) {
    EXPECT_THAT(daemon_.log(), Not(HasSubstr(hidden)));
    EXPECT_THAT(relay_.log(), Not(HasSubstr(hidden)));
    EXPECT_THAT(daemon_.ctl({"key", "list", "--json"}).out, Not(HasSubstr(hidden)));
  }
}

}  // namespace
}  // namespace dts::test
