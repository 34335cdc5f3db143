// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/settings.h"

#include <gtest/gtest.h>

#include <fstream>

#include "fleet/wire/nkey.h"
#include "support/temporary_folder.h"

namespace dts::fleet::hub {
namespace {

class SettingsTest : public testing::Test {
 protected:
  Settings load(const std::string& text) {
    const std::string file = folder_.path() + "/hub.toml";
    std::ofstream(file) << text;
    problems_.clear();
    return load_settings(file, problems_);
  }
  /// Returns the problem of a file with one mistake.
  std::string problem_of(const std::string& text) {
    static_cast<void>(load(text));
    return problems_.size() == 1 ? problems_.front().text : std::to_string(problems_.size()) + " problems";
  }

  static constexpr const char* kSound = R"(name = "hub-1"
[nats]
servers = ["tls://127.0.0.1:4222"]
ca = "ca.pem"
key = "hub.nk"
users_file = "/etc/nats/users.conf"
[database]
connection = "dbname=dts_fleet"
[store]
directory = "store"
)";
  test::TemporaryFolder folder_;
  files::Problems problems_;
};

TEST_F(SettingsTest, FilesAreRelativeToTheConfiguration) {
  const Settings settings =
      load(std::string(kSound) +
           "full_at_percent = 90\n[quota]\nbytes_a_day = 7\nmessages_per_s = 50\nsessions = 8\n[metrics]\nlisten = \"127.0.0.1:9464\"\n");
  EXPECT_TRUE(problems_.empty()) << files::to_string(problems_.front());
  EXPECT_EQ(settings.name, "hub-1");
  EXPECT_EQ(settings.ca_file, folder_.path() + "/ca.pem");
  EXPECT_EQ(settings.key_file, folder_.path() + "/hub.nk");
  EXPECT_EQ(settings.users_file, "/etc/nats/users.conf");
  EXPECT_EQ(settings.pid_file, "");
  EXPECT_EQ(settings.directory, folder_.path() + "/store");
  EXPECT_EQ(settings.public_servers, settings.servers);
  EXPECT_EQ(settings.full_at_percent, 90.0);
  EXPECT_EQ(settings.quota.bytes_a_day, 7U);
  EXPECT_EQ(settings.quota.staged_bytes, 100'000'000'000U);
  EXPECT_EQ(settings.quota.messages_per_s, 50.0);
  EXPECT_EQ(settings.quota.sessions, 8U);
  EXPECT_EQ(settings.metrics_address, "127.0.0.1");
  EXPECT_EQ(settings.metrics_port, 9464);
}

TEST_F(SettingsTest, Mistakes_AreNamed) {
  EXPECT_NE(problem_of(std::string("nmae = \"x\"\n") + kSound).find("nmae"), std::string::npos);
  const std::string sound = kSound;
  EXPECT_NE(problem_of("name = \"Hub 1\"" + sound.substr(sound.find('\n'))).find("a-z"), std::string::npos);
  for (const std::string listen : {"9464", "localhost:9464", "127.0.0.1:", "127.0.0.1:99999", "127.0.0.1:94x"}) {
    EXPECT_NE(problem_of(sound + "[metrics]\nlisten = \"" + listen + "\"\n").find("IPv4"), std::string::npos) << listen;
  }
  EXPECT_NE(problem_of(sound + "[quota]\nbytes_a_day = 0\n").find("bytes_a_day"), std::string::npos);
}

TEST_F(SettingsTest, DashboardsHaveAKey_AndPerhapsClinics) {
  const std::string one = wire::create_nkey().public_key;
  const std::string other = wire::create_nkey().public_key;
  const std::string sound = kSound;
  const Settings settings =
      load(sound + "[[dashboard]]\nkey = \"" + one + "\"\n[[dashboard]]\nkey = \"" + other + "\"\nclinics = [\"kent\"]\n");
  ASSERT_TRUE(problems_.empty()) << files::to_string(problems_.front());
  ASSERT_EQ(settings.dashboards.size(), 2U);
  EXPECT_EQ(settings.dashboards[0].public_key, one);
  EXPECT_TRUE(settings.dashboards[0].clinics.empty());
  EXPECT_EQ(settings.dashboards[1].clinics, std::vector<std::string>{"kent"});
  const std::string keyed = sound + "[[dashboard]]\nkey = \"" + one + "\"\n";
  EXPECT_NE(problem_of(sound + "[[dashboard]]\nclinics = [\"kent\"]\n").find("key"), std::string::npos);
  EXPECT_NE(problem_of(sound + "[[dashboard]]\nkey = \"U\\\"}\"\n").find("public key"), std::string::npos);
  EXPECT_NE(problem_of(keyed + "clinics = []\n").find("names no clinic"), std::string::npos);
  EXPECT_NE(problem_of(keyed + "clinics = [\"*\"]\n").find("a-z"), std::string::npos);
  EXPECT_NE(problem_of(keyed + "[[dashboard]]\nkey = \"" + one + "\"\n").find("another dashboard"), std::string::npos);
}

TEST_F(SettingsTest, ABucket_IsATableOfItsOwn) {
  EXPECT_FALSE(load(kSound).s3);
  const Settings settings = load(std::string(kSound) +
                                 "[store.s3]\nendpoint = \"https://s3.example.org\"\nbucket = \"recordings\"\nregion = \"eu-west-2\"\n"
                                 "credentials = \"s3.keys\"\n");
  EXPECT_TRUE(problems_.empty());
  ASSERT_TRUE(settings.s3);
  EXPECT_EQ(settings.s3->endpoint, "https://s3.example.org");
  EXPECT_EQ(settings.s3->credentials_file, folder_.path() + "/s3.keys");
  EXPECT_EQ(settings.directory, folder_.path() + "/store");  // of staged files
}

TEST_F(SettingsTest, MissingTables_AreNamed) {
  static_cast<void>(load(""));
  EXPECT_EQ(problems_.size(), 4U);  // name, nats, database, store
}

TEST_F(SettingsTest, Ca_MustBeReadable) {
  const Settings settings = load(kSound);
  EXPECT_EQ(read_ca(settings).error().code, core::ErrorCode::InvalidArgument);
  std::ofstream(folder_.path() + "/ca.pem") << "PEM";
  EXPECT_EQ(read_ca(settings), "PEM");
}

}  // namespace
}  // namespace dts::fleet::hub
