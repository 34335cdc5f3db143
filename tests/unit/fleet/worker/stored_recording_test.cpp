// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/stored_recording.h"

#include <optional>

#include "record/sha256.h"
#include "unit/fleet/worker/script_fixture.h"

namespace dts::fleet::worker {
namespace {

using ::testing::EndsWith;

class StoredRecordingTest : public ::testing::Test {
 protected:
  std::string file(const std::string& content) {
    std::ofstream(folder_.path() + "/stored") << content;
    return folder_.path() + "/stored";
  }
  [[nodiscard]] static core::ErrorCode code(const core::Status& status) {
    EXPECT_FALSE(status);
    return status ? core::ErrorCode::Internal : status.error().code;
  }

  test::TemporaryFolder folder_{};
};

constexpr auto kOn = [] { return true; };

TEST_F(StoredRecordingTest, Key_LeadsIntoTheFolder) {
  EXPECT_EQ(stored_file("/store", "objects/kent/ab").value(), "/store/objects/kent/ab");
  for (const char* const key : {"../etc/passwd", "objects/../../x", "/etc/passwd"}) {
    EXPECT_EQ(stored_file("/store", key).error().code, core::ErrorCode::DataDamaged) << key;
  }
  EXPECT_EQ(stored_file("/store", "").error().code, core::ErrorCode::NotFound);
}

TEST_F(StoredRecordingTest, Content_MustBeWhatTheCatalogueNames) {
  const std::string content(3'000'000, 'x');
  EXPECT_TRUE(check_sha256(file(content), record::sha256_of(content), kOn));
  EXPECT_EQ(code(check_sha256(file(content + "y"), record::sha256_of(content), kOn)), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code(check_sha256(file(content), "", kOn)), core::ErrorCode::DataDamaged);
  EXPECT_EQ(code(check_sha256(folder_.path() + "/none", "", kOn)), core::ErrorCode::NotFound);
}

TEST_F(StoredRecordingTest, Check_CanBeStopped) {
  const std::string content(3'000'000, 'x');
  int calls = 0;
  EXPECT_EQ(code(check_sha256(file(content), record::sha256_of(content), [&] { return ++calls < 2; })), core::ErrorCode::WrongState);
  EXPECT_EQ(calls, 2);
}

TEST_F(StoredRecordingTest, Name_EndsInXdf_AndIsRemoved) {
  std::string path;
  {
    const auto name = RecordingName::create(file("content"));
    ASSERT_TRUE(name) << name.error().what;
    path = name->path();
    EXPECT_THAT(path, EndsWith(".xdf"));
    std::string read;
    std::ifstream(path) >> read;
    EXPECT_EQ(read, "content");
  }
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::symlink_status(path)));
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(path).parent_path()));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() + "/stored"));
}

}  // namespace
}  // namespace dts::fleet::worker
