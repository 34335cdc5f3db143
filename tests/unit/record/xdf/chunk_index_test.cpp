// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/chunk_index.h"

#include <gtest/gtest.h>

#include <limits>

#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

ChunkNote note(std::uint64_t offset, std::uint64_t length) { return {.offset = offset, .length = length, .crc32c = 0xABU}; }

TEST(ChunkIndex, Crc_IsCastagnoli) {
  EXPECT_EQ(crc32c("123456789"), 0xE3069283U);  // the check value of CRC-32C in the catalogue of parametrised CRCs
  EXPECT_EQ(crc32c(""), 0U);
}

TEST(ChunkIndex, Line_IsAsDocumentedAndComesBack) {
  const ChunkNote whole{1824, 3022, 0x9F3C2A11U, 1, 0, 375, 375, 8123.251};
  EXPECT_EQ(to_line(whole), "1824 3022 9f3c2a11 1 0 375 375 8123.251000000");
  EXPECT_EQ(note_of_line(to_line(whole)), whole);
  const auto most = std::numeric_limits<std::uint64_t>::max();
  const ChunkNote extreme{most, most, 0U, 4294967295U, 4294967295U, most, most, -1e300};
  EXPECT_EQ(note_of_line(to_line(extreme)), extreme);
}

TEST(ChunkIndex, LineOfAnotherForm_IsRefused) {
  for (const char* line :
       {"", "4", "4 5 0000000a 1 2 3 4", "4 5 0000000a 1 2 3 4 5.0 ", "4 5 0000000a 1 2 3 4 5.0 6", " 4 5 0000000a 1 2 3 4 5",
        "4  5 0000000a 1 2 3 4 5", "-4 5 0000000a 1 2 3 4 5", "4 5 a 1 2 3 4 5", "4 5 0000000g 1 2 3 4 5", "4 5 0000000a 1 2 3 4 nan",
        "4 5 0000000a 1 2 3 4 1e999", "99999999999999999999 5 0000000a 1 2 3 4 5", "4 5 0000000a 4294967296 2 3 4 5"})
    EXPECT_FALSE(note_of_line(line)) << line;
  EXPECT_FALSE(note_of_line(std::string(5000, '1')));
}

TEST(ChunkIndex, TornOrContradictingLine_EndsIt) {
  const Folder folder;
  const std::string good = to_line(note(4, 10)) + "\n" + to_line(note(14, 5)) + "\n";
  for (const std::string& tail :
       {std::string(), std::string("19 7 0000"), to_line(note(19, 7)), to_line(note(20, 7)) + "\n" + to_line(note(27, 1)) + "\n",
        std::string("\n") + to_line(note(19, 7)) + "\n", std::string(3000, 'x') + "\n", to_line(note(18, 7)) + "\n"}) {
    put_file(folder / "i", good + tail);
    const auto notes = read_index(folder / "i");
    ASSERT_TRUE(notes);
    EXPECT_EQ(*notes, (std::vector<ChunkNote>{note(4, 10), note(14, 5)})) << tail;
    IndexReader reader(folder / "i");
    while (reader.next()) {
    }
    EXPECT_FALSE(reader.next()) << "what stands behind a torn line is not believed: " << tail;
  }
}

TEST(ChunkIndex, LengthThatWraps_EndsIt) {
  const Folder folder;
  put_file(folder / "i", to_line(note(4, std::numeric_limits<std::uint64_t>::max())) + "\n" + to_line(note(3, 1)) + "\n");
  EXPECT_TRUE(read_index(folder / "i")->empty());
}

TEST(ChunkIndex, NoFile_IsNotFound) {
  const Folder folder;
  const auto notes = read_index(folder / "none");
  ASSERT_FALSE(notes);
  EXPECT_EQ(notes.error().code, core::ErrorCode::NotFound);
}

TEST(ChunkIndex, Name_IsTheSameWhileGrowingAndClosed) {
  EXPECT_EQ(index_name("d/a.xdf"), "d/a.xdf.idx");
  EXPECT_EQ(index_name("d/a.xdf.part"), "d/a.xdf.idx");
}

}  // namespace
}  // namespace dts::record::xdf_test
