// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/settings.h"

#include "unit/fleet/worker/script_fixture.h"

namespace dts::fleet::worker {
namespace {

using ::testing::HasSubstr;

class SettingsTest : public ::testing::Test {
 protected:
  WorkerOptions read(const std::string& text) {
    std::ofstream(folder_.path() + "/worker.toml") << text;
    problems_.clear();
    return read_settings(folder_.path() + "/worker.toml", problems_);
  }
  [[nodiscard]] std::string problems() const {
    std::string text;
    for (const files::Problem& problem : problems_) text += problem.text + "\n";
    return text;
  }

  test::TemporaryFolder folder_{};
  files::Problems problems_{};
};

constexpr const char* kLeast = "[database]\nconnection = \"dbname=x\"\n[store]\ndirectory = \"/store\"\n";

TEST_F(SettingsTest, Least_IsDatabaseAndStore) {
  const WorkerOptions options = read(kLeast);
  EXPECT_EQ(problems(), "");
  EXPECT_EQ(options.connection, "dbname=x");
  EXPECT_EQ(options.store, "/store");
  EXPECT_EQ(options.dtslab, "/usr/bin/dtslab");
  EXPECT_EQ(options.limits.time, std::chrono::minutes(10));
  EXPECT_EQ(options.limits.memory_bytes, 4ULL << 30U);
  EXPECT_EQ(options.limits.output_bytes, 16U << 20U);
  EXPECT_EQ(options.lease, std::chrono::seconds(60));
}

TEST_F(SettingsTest, All_AreRead_AndPathsAreRelativeToTheFile) {
  const WorkerOptions options = read(
      "dtslab = \"bin/dtslab\"\n[database]\nconnection = \"dbname=x\"\n[store]\ndirectory = \"store\"\n"
      "[limits]\ntime_s = 5\nmemory_mib = 100\n[jobs]\nlease_s = 7\nretry_pause_s = 0\n");
  EXPECT_EQ(problems(), "");
  EXPECT_EQ(options.dtslab, folder_.path() + "/bin/dtslab");
  EXPECT_EQ(options.store, folder_.path() + "/store");
  EXPECT_EQ(options.limits.time, std::chrono::seconds(5));
  EXPECT_EQ(options.limits.memory_bytes, 100ULL << 20U);
  EXPECT_EQ(options.lease, std::chrono::seconds(7));
  EXPECT_EQ(options.retry_pause, std::chrono::seconds(0));
}

TEST_F(SettingsTest, ABucket_ReplacesTheFolder) {
  const WorkerOptions options = read(
      "[database]\nconnection = \"dbname=x\"\n[store.s3]\nendpoint = \"https://s3.example.org\"\nbucket = \"recordings\"\n"
      "region = \"eu-west-2\"\ncredentials = \"s3.keys\"\n");
  EXPECT_EQ(problems(), "");
  ASSERT_TRUE(options.s3);
  EXPECT_EQ(options.s3->bucket, "recordings");
  EXPECT_EQ(options.s3->credentials_file, folder_.path() + "/s3.keys");
}

TEST_F(SettingsTest, Example_IsRead) {
  const WorkerOptions options = read_settings(std::string(DTS_SOURCE_DIR) + "/config/worker.toml", problems_);
  EXPECT_EQ(problems(), "");
  EXPECT_EQ(options.store, "/var/lib/dts-hub");
  EXPECT_EQ(options.dtslab, "/usr/bin/dtslab");
}

TEST_F(SettingsTest, WhatIsMissingOrWrong_IsAProblem) {
  static_cast<void>(read("[database]\n[store]\ndirectory = \"/store\"\n"));
  EXPECT_THAT(problems(), HasSubstr("connection"));
  static_cast<void>(read("[database]\nconnection = \"dbname=x\"\n"));
  EXPECT_THAT(problems(), HasSubstr("[store] is missing"));
  static_cast<void>(read(std::string(kLeast) + "[limits]\ntime_s = 0\nmemory_mib = 1\n"));
  EXPECT_THAT(problems(), HasSubstr("time_s"));
  EXPECT_THAT(problems(), HasSubstr("memory_mib"));
  static_cast<void>(read("dtslap = \"x\"\n" + std::string(kLeast)));
  EXPECT_THAT(problems(), HasSubstr("dtslap"));
}

}  // namespace
}  // namespace dts::fleet::worker
