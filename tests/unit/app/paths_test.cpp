// SPDX-License-Identifier: Apache-2.0
#include "app/paths.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace dts::app {
namespace {

class Paths : public ::testing::Test {
 protected:
  Paths() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-paths-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~Paths() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_;
};

TEST_F(Paths, AbsentDirectory_IsMadeForOwnerAndGroupOnly) {
  const std::string path = (folder_ / "a" / "b").string();

  ASSERT_TRUE(prepare_directory(path));

  struct stat made {};
  ASSERT_EQ(::stat(path.c_str(), &made), 0);
  EXPECT_EQ(made.st_mode & 0027U, 0U) << "neither writable for the group nor open to others";
}

TEST_F(Paths, FileInItsPlace_IsRefused) {
  const std::string path = (folder_ / "file").string();
  std::ofstream(path) << "x";

  EXPECT_FALSE(prepare_directory(path));
}

TEST_F(Paths, UnwritableDirectory_IsRefusedWithAHint) {
  const auto prepared = prepare_directory("/proc/dtsd");  // nobody can make this one, not even root

  ASSERT_FALSE(prepared);
  EXPECT_FALSE(prepared.error().hint.empty());
}

TEST_F(Paths, DirectoryThatEverybodyMayWrite_IsRefused) {
  const std::string path = (folder_ / "open").string();
  ::mkdir(path.c_str(), 0700);
  ::chmod(path.c_str(), 0777);

  EXPECT_FALSE(prepare_directory(path));
}

TEST_F(Paths, SecondLock_IsRefusedUntilTheFirstEnds) {
  auto first = std::make_unique<core::Result<DirectoryLock>>(DirectoryLock::take(folder_.string()));
  ASSERT_TRUE(first->has_value());

  const auto second = DirectoryLock::take(folder_.string());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, core::ErrorCode::WrongState);

  first.reset();
  EXPECT_TRUE(DirectoryLock::take(folder_.string()));
}

}  // namespace
}  // namespace dts::app
