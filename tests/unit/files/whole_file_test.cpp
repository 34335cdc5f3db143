// SPDX-License-Identifier: Apache-2.0
#include "files/whole_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "unit/files/files_fixture.h"

namespace dts::files {
namespace {

class WholeFile : public FilesTest {
 protected:
  /// Empty after a success.
  [[nodiscard]] std::string refusal(const core::Status& status) const { return status ? "" : without_folder(status.error().what); }
  [[nodiscard]] mode_t rights(const std::string& name) const {
    struct stat now {};
    EXPECT_EQ(::stat(path(name).c_str(), &now), 0);
    return now.st_mode & 07777U;
  }
  [[nodiscard]] auto entries() const { return std::distance(std::filesystem::directory_iterator(folder_), {}); }
};

TEST_F(WholeFile, NewFile_IsThereWithItsRightsAndNothingElse) {
  for (const char* text : {"text", "another"}) {
    ASSERT_TRUE(write_whole_file(path("new"), text, 0640));
    EXPECT_EQ(content_of(path("new")), text);
    EXPECT_EQ(rights("new"), 0640U);
    EXPECT_EQ(entries(), 1);
  }
}

TEST_F(WholeFile, PieceByPiece_IsThereOnlyAfterTheCommit) {
  {
    auto writer = WholeFileWriter::create(path("pieces"));
    ASSERT_TRUE(writer.has_value());
    ASSERT_TRUE(writer->append("one "));
    ASSERT_TRUE(writer->append("two"));
    EXPECT_FALSE(std::filesystem::exists(path("pieces")));
    WholeFileWriter moved = std::move(*writer);
    ASSERT_TRUE(moved.commit());
    EXPECT_EQ(content_of(path("pieces")), "one two");
  }
  {
    auto abandoned = WholeFileWriter::create(path("pieces"));
    ASSERT_TRUE(abandoned->append("three"));
  }
  EXPECT_EQ(content_of(path("pieces")), "one two");
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFile, OldFile_KeepsItsRights) {
  for (const mode_t mode : {0600U, 0666U}) {
    ASSERT_EQ(::chmod(write("old", "before").c_str(), mode), 0);
    ASSERT_TRUE(write_whole_file(path("old"), "after"));
    EXPECT_EQ(rights("old"), mode);
    EXPECT_EQ(content_of(path("old")), "after");
  }
}

TEST_F(WholeFile, Link_StaysALink) {
  write("target", "before");
  std::filesystem::create_symlink("target", path("link"));
  ASSERT_TRUE(write_whole_file(path("link"), "after"));
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  EXPECT_EQ(content_of(path("target")), "after");
}

TEST_F(WholeFile, Device_IsWrittenToAndNotReplaced) {
  // Links to the devices: the test must not be able to replace the real ones.
  std::filesystem::create_symlink("/dev/full", path("full"));
  std::filesystem::create_symlink("/dev/null", path("null"));
  EXPECT_EQ(refusal(write_whole_file(path("full"), "text")), "cannot write full: No space left on device");
  EXPECT_TRUE(write_whole_file(path("null"), "text"));
  for (const char* device : {"full", "null"}) {
    EXPECT_TRUE(std::filesystem::is_character_file(path(device)));
    EXPECT_TRUE(std::filesystem::is_symlink(path(device)));
  }
}

TEST_F(WholeFile, CannotBeWritten_NamesTheFileAndLeavesNothing) {
  EXPECT_EQ(refusal(write_whole_file(path("none/file"), "text")), "cannot write none/file: No such file or directory");
  std::filesystem::create_directories(path("folder/inside"));
  EXPECT_EQ(refusal(write_whole_file(path("folder"), "new")), "cannot write folder: Is a directory");
  EXPECT_TRUE(std::filesystem::exists(path("folder/inside")));
  EXPECT_EQ(entries(), 1);
}

TEST_F(WholeFile, ReadingWhatIsNoFileOrTooLong_IsRefusedAndDoesNotWait) {
  constexpr std::size_t kMost = std::size_t{1} << 20U;
  const std::string text(kMost, 'x');
  ASSERT_EQ(::mkfifo(path("pipe").c_str(), 0600), 0);
  EXPECT_EQ(read_whole_file(path("pipe"), kMost).error().what, "is not a regular file");
  EXPECT_EQ(read_whole_file("/dev/zero", kMost).error().what, "is not a regular file");
  EXPECT_EQ(read_whole_file("/", kMost).error().what, "is a folder, not a file");
  EXPECT_EQ(read_whole_file("/no/such/file", kMost).error().what, "cannot be read: No such file or directory");
  EXPECT_EQ(read_whole_file(write("file", text), kMost).value(), text);
  EXPECT_EQ(read_whole_file(write("file", text + "x"), kMost).error().what, "is larger than 1 MiB: this is not a file of dtsd");
}

}  // namespace
}  // namespace dts::files
