// SPDX-License-Identifier: Apache-2.0
#include "files/whole_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

namespace dts::files {
namespace {

std::string content_of(const std::filesystem::path& path) {
  std::ifstream stream(path);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class WholeFile : public testing::Test {
 protected:
  WholeFile() { std::filesystem::create_directory(folder_); }
  ~WholeFile() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_ = testing::TempDir() + "/whole_file_" + std::to_string(::getpid());
};

TEST_F(WholeFile, NewFile_IsThereAndNothingElse) {
  for (const char* text : {"text", "another"}) {
    ASSERT_TRUE(write_whole_file(folder_ / "new", text));
    EXPECT_EQ(content_of(folder_ / "new"), text);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
  }
}

TEST_F(WholeFile, OldFile_KeepsItsRights) {
  std::ofstream(folder_ / "old") << "before";
  ASSERT_EQ(::chmod((folder_ / "old").c_str(), 0600), 0);
  ASSERT_TRUE(write_whole_file(folder_ / "old", "after"));
  struct stat now {};
  ASSERT_EQ(::stat((folder_ / "old").c_str(), &now), 0);
  EXPECT_EQ(now.st_mode & 07777U, 0600U);
  EXPECT_EQ(content_of(folder_ / "old"), "after");
}

TEST_F(WholeFile, Link_StaysALink) {
  std::ofstream(folder_ / "target") << "before";
  std::filesystem::create_symlink("target", folder_ / "link");
  ASSERT_TRUE(write_whole_file(folder_ / "link", "after"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link"));
  EXPECT_EQ(content_of(folder_ / "target"), "after");
}

TEST_F(WholeFile, Device_IsWrittenToAndNotReplaced) {
  const auto device = folder_ / "null";  // a link to the device: the test must not be able to replace the real one
  std::filesystem::create_symlink("/dev/full", device);
  EXPECT_FALSE(write_whole_file(device, "text"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
  EXPECT_TRUE(std::filesystem::is_symlink(device));
}

TEST_F(WholeFile, NoFolder_IsRefusedNamingTheFile) {
  EXPECT_NE(write_whole_file(folder_ / "none" / "file", "text").error().what.find("none/file"), std::string::npos);
}

TEST(ReadWholeFile, Pipe_IsRefusedAndNotWaitedFor) {
  const std::string pipe = ::testing::TempDir() + "read_whole_file_pipe";
  ::unlink(pipe.c_str());
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);

  const auto read = read_whole_file(pipe, 1024);
  ::unlink(pipe.c_str());

  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().what, "is no regular file");
}

TEST(ReadWholeFile, DevicesFoldersAndNothing_AreRefused) {
  EXPECT_EQ(read_whole_file("/dev/zero", 1024).error().what, "is no regular file");
  EXPECT_EQ(read_whole_file("/", 1024).error().what, "is a folder, not a file");
  EXPECT_EQ(read_whole_file("/no/such/file", 1024).error().what, "cannot be read: No such file or directory");
}

TEST(ReadWholeFile, TooLong_IsRefused) {
  const std::string file = ::testing::TempDir() + "read_whole_file_long";
  ASSERT_TRUE(write_whole_file(file, std::string(std::size_t{1} << 20U, 'x')));

  EXPECT_EQ(read_whole_file(file, std::size_t{1} << 20U).value().size(), std::size_t{1} << 20U);
  EXPECT_FALSE(read_whole_file(file, (std::size_t{1} << 20U) - 1));
  ::unlink(file.c_str());
}

}  // namespace
}  // namespace dts::files
