// SPDX-License-Identifier: Apache-2.0
#include "fleet/s3/settings.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/temporary_folder.h"

namespace dts::fleet::s3 {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class S3SettingsTest : public ::testing::Test {
 protected:
  Settings load(const std::string& table) {
    problems_.clear();
    const auto parsed = files::parse_toml_text("s3 = {" + table + "}", folder_.path() + "/hub.toml", problems_);
    files::TomlReader top(parsed ? &*parsed : nullptr, "", folder_.path() + "/hub.toml", problems_);
    return read_settings(top.table("s3"));
  }
  std::string credentials(const std::string& text, fs::perms mode = fs::perms(0600)) {
    std::ofstream(folder_.path() + "/keys") << text;
    fs::permissions(folder_.path() + "/keys", mode);
    return folder_.path() + "/keys";
  }
  static std::string table_of(const std::string& endpoint, const std::string& bucket = "recordings",
                              const std::string& region = "eu-west-2") {
    return "endpoint=\"" + endpoint + "\", bucket=\"" + bucket + "\", region=\"" + region + "\", credentials=\"keys\"";
  }

  test::TemporaryFolder folder_;
  files::Problems problems_;
};

TEST_F(S3SettingsTest, FilesAreRelativeToTheConfiguration) {
  const Settings settings = load(table_of("https://s3.example.org") + ", ca = \"ca.pem\"");
  EXPECT_THAT(problems_, SizeIs(0));
  EXPECT_EQ(settings.endpoint, "https://s3.example.org");
  EXPECT_EQ(settings.credentials_file, folder_.path() + "/keys");
  EXPECT_EQ(settings.ca_file, folder_.path() + "/ca.pem");
}

TEST_F(S3SettingsTest, WithoutTls_OnlyThisMachine) {
  for (const char* const good : {"http://127.0.0.1:9000", "http://localhost:9000", "https://10.0.0.1:9000"}) {
    static_cast<void>(load(table_of(good)));
    EXPECT_THAT(problems_, SizeIs(0)) << good;
  }
  for (const char* const wrong : {"http://s3.example.org", "http://localhost.example.org", "http://127.0.0.1.example.org", "s3.example.org",
                                  "https://", "https://s3.example.org/path", "https://a@b"}) {
    static_cast<void>(load(table_of(wrong)));
    EXPECT_THAT(problems_, SizeIs(1)) << wrong;
  }
}

TEST_F(S3SettingsTest, Mistakes_AreNamed) {
  for (const char* const bucket : {"", "ab", "A-bucket", "a/b", "a..b"}) {
    static_cast<void>(load(table_of("https://s3.example.org", bucket)));
    ASSERT_THAT(problems_, SizeIs(1)) << bucket;
    EXPECT_THAT(problems_.front().text, HasSubstr("3 to 63"));
  }
  static_cast<void>(load(table_of("https://s3.example.org", "recordings", "eu:s3")));
  EXPECT_THAT(problems_, SizeIs(1));
  static_cast<void>(load(table_of("https://s3.example.org") + ", secret = \"x\""));
  EXPECT_THAT(problems_, SizeIs(1));
  static_cast<void>(load(""));
  EXPECT_THAT(problems_, SizeIs(4));
}

TEST_F(S3SettingsTest, Credentials_AreTwoLines) {
  const auto read = read_credentials(credentials("AKIA1\nsecret/+1\n"));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->access_key, "AKIA1");
  EXPECT_EQ(read->secret_key, "secret/+1");
  for (const char* const wrong : {"", "AKIA1", "AKIA1\n", "\nsecret\n", "AKIA1\nsecret\nmore\n", "AK IA\nsecret\n", "AK:IA\nsecret\n"}) {
    EXPECT_EQ(read_credentials(credentials(wrong)).error().code, core::ErrorCode::InvalidArgument) << wrong;
  }
  EXPECT_FALSE(read_credentials(folder_.path() + "/none"));
  const std::string longest = "AKIA1\n" + std::string(1024 - 6, 's');
  EXPECT_TRUE(read_credentials(credentials(longest)));
  EXPECT_FALSE(read_credentials(credentials(longest + "s")));
}

TEST_F(S3SettingsTest, Credentials_ThatOthersCanRead_AreRejected) {
  const auto read = read_credentials(credentials("AKIA1\nsecret\n", fs::perms(0640)));
  EXPECT_EQ(read.error().code, core::ErrorCode::NotAllowed);
  EXPECT_THAT(read.error().hint, HasSubstr("chmod 600"));
}

}  // namespace
}  // namespace dts::fleet::s3
