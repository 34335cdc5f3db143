// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/users_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "files/toml_reader.h"
#include "fleet/wire/nkey.h"
#include "support/nats_server.h"
#include "support/temporary_folder.h"
#include "unit/fleet/hub/hub_fixture.h"

namespace dts::fleet::hub {
namespace {

TEST(UsersFile, HasTheHubAndTheClinicsThatAreNotRevoked) {
  const auto hub = wire::create_nkey().public_key;
  const auto kent = wire::create_nkey().public_key;
  const auto leeds = wire::create_nkey().public_key;
  const std::string text =
      users_text(hub, {}, {{.id = "kent", .title = "", .nkey = kent}, {.id = "leeds", .title = "", .nkey = leeds, .is_revoked = true}});
  EXPECT_NE(text.find(hub), std::string::npos);
  EXPECT_NE(text.find("{nkey: " + kent + ", permissions: {publish: {allow: [\"dts.v1.kent.up.>\""), std::string::npos) << text;
  EXPECT_EQ(text.find(leeds), std::string::npos);
  EXPECT_EQ(text.find("leeds"), std::string::npos);
}

TEST(UsersFile, DashboardsMayAnswerNothing) {
  const auto all = wire::create_nkey().public_key;
  const auto one = wire::create_nkey().public_key;
  const std::string text = users_text("UA", {{.public_key = all, .clinics = {}}, {.public_key = one, .clinics = {"kent"}}}, {});
  const std::string end = ", \"dts.v1.*.live.>\"]}}}\n";
  EXPECT_NE(text.find("{nkey: " + all + ", permissions: {publish: {allow: [\"dts.v1.*.down.live\"]}, subscribe: {allow: [\"_DASHBOARD." +
                      all + ".>\"" + end),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("{nkey: " + one + ", permissions: {publish: {allow: [\"dts.v1.kent.down.live\"]}"), std::string::npos) << text;
}

TEST(UsersFile, RowsThatAreNoNameAndKey_AreLeftOut) {
  const auto key = wire::create_nkey().public_key;
  const std::string text = users_text(key, {}, {{.id = "x\"}]}", .title = "", .nkey = key}, {.id = "kent", .title = "", .nkey = "U\"}"}});
  EXPECT_EQ(text.find("x\"}"), std::string::npos);
  EXPECT_EQ(text.find("kent"), std::string::npos);
}

TEST(UsersFile, AKeyWithTwoUsers_IsWrittenOnce_SoThatNatsServerReadsTheFile) {
  const auto hub = wire::create_nkey().public_key;
  const auto dashboard = wire::create_nkey().public_key;
  const std::vector<DashboardKey> dashboards = {{.public_key = dashboard, .clinics = {}}, {.public_key = hub, .clinics = {}}};
  const std::vector<Clinic> clinics = {{.id = "kent", .title = "", .nkey = dashboard},
                                       {.id = "leeds", .title = "", .nkey = hub},
                                       {.id = "york", .title = "", .nkey = wire::create_nkey().public_key}};
  const std::string text = users_text(hub, dashboards, clinics);
  EXPECT_EQ(text.find("kent"), std::string::npos) << text;
  EXPECT_EQ(text.find("leeds"), std::string::npos) << text;
  EXPECT_NE(text.find("york"), std::string::npos) << text;
  const auto checked = check_keys(hub, dashboards, clinics);
  ASSERT_FALSE(checked);
  for (const std::string problem : {"a [[dashboard]] has the key of the hub", "clinic 'kent' has the key of a [[dashboard]]",
                                    "clinic 'leeds' has the key of the hub"}) {
    EXPECT_NE(checked.error().what.find(problem), std::string::npos) << checked.error().what;
  }
  EXPECT_TRUE(check_keys(hub, {dashboards.front()}, {clinics.back(), {.id = "kent", .title = "", .nkey = hub, .is_revoked = true}}));
  if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
  const test::TemporaryFolder folder;
  std::ofstream(folder.path() + "/users.conf") << text;
  const std::string test = *test::NatsServer::program() + " -t -c " + folder.path() + "/users.conf > " + folder.path() + "/log 2>&1";
  EXPECT_EQ(std::system(test.c_str()), 0) << content_of(folder.path() + "/log");
}

TEST(UsersFile, IsWrittenOnlyIfItDiffers) {
  const test::TemporaryFolder folder;
  Settings settings;
  EXPECT_EQ(write_users(settings, "UA", {}), false);  // another hub writes it
  settings.users_file = folder.path() + "/users.conf";
  EXPECT_EQ(write_users(settings, "UA", {}), true);
  EXPECT_EQ(write_users(settings, "UA", {}), false);
  EXPECT_EQ(write_users(settings, "UB", {}), true);
  EXPECT_EQ(content_of(settings.users_file), users_text("UB", {}, {}));
}

TEST(UsersFile, OnlyANatsServerIsSignalled) {
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/pid";
  EXPECT_EQ(reload_nats(file).error().code, core::ErrorCode::NotFound);
  for (const std::string& text : {std::to_string(::getpid()), std::string("1"), std::string("-1"), std::string("x"), std::string()}) {
    std::ofstream(file) << text;
    EXPECT_EQ(reload_nats(file).error().code, core::ErrorCode::NotFound) << text;
  }
}

/// Returns how `reload_nats` fails as another user: its code and its message. Ends the process.
[[noreturn]] void reload_as_nobody(const std::string& pid_file) {
  constexpr uid_t kNobody = 65534;
  if (::setresuid(kNobody, kNobody, kNobody) != 0) ::_exit(100);
  const auto reloaded = reload_nats(pid_file);
  if (!reloaded) std::cerr << core::to_string(reloaded.error()) << std::endl;
  ::_exit(reloaded ? 101 : static_cast<int>(reloaded.error().code));
}

TEST(UsersFile, WithoutPermission_TheReasonIsNamed) {
  if (::getuid() != 0) GTEST_SKIP() << "only root can act as another user";
  if (!test::NatsServer::program()) GTEST_SKIP() << "nats-server is not installed";
  const test::NatsServer server;
  const test::TemporaryFolder folder;
  const std::string file = folder.path() + "/pid";
  std::ofstream(file) << server.pid();
  EXPECT_TRUE(reload_nats(file));
  constexpr int kNotAllowed = static_cast<int>(core::ErrorCode::NotAllowed);
  EXPECT_EXIT(reload_as_nobody(file), testing::ExitedWithCode(kNotAllowed), "cannot read .*pid: Permission denied.*dts-hub-users.path");
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  std::filesystem::permissions(file, std::filesystem::perms(0644));
  EXPECT_EXIT(reload_as_nobody(file), testing::ExitedWithCode(kNotAllowed),
              "may not signal process " + std::to_string(server.pid()) + ": Permission denied.*dts-hub-users.path");
}

TEST(Enrolment, IsReadAsItWasWritten) {
  for (const std::string pem : {"-----BEGIN CERTIFICATE-----\nabc=\n-----END CERTIFICATE-----\n", "a \"\"\" and \\ within"}) {
    files::Problems problems;
    const std::string text = enrolment_text("kent", {"tls://a:1", "tls://b:2"}, pem);
    const auto table = files::parse_toml_text(text, "kent.toml", problems);
    ASSERT_TRUE(table) << text;
    files::TomlReader reader(&*table, "", "kent.toml", problems);
    EXPECT_EQ(reader.text("clinic", ""), "kent");
    EXPECT_EQ(reader.texts("servers", {}), (std::vector<std::string>{"tls://a:1", "tls://b:2"}));
    EXPECT_EQ(reader.text("ca", ""), pem);
    reader.finish();
    EXPECT_TRUE(problems.empty());
  }
}

}  // namespace
}  // namespace dts::fleet::hub
