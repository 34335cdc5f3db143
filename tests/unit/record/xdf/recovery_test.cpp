// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/recovery.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <sstream>

#include "record/recording.h"
#include "record/xdf/chunk_index.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

/// A recording whose daemon was killed: NAME.part and its index.
std::string killed(const Folder& folder) {
  small_recording(folder / "a.xdf")->abandon();
  return folder / "a.xdf.part";
}
std::string closed(const Folder& folder) {
  EXPECT_TRUE(small_recording(folder / "a.xdf")->close());
  return folder / "a.xdf";
}
std::string index_of(const Folder& folder) { return folder / "a.xdf.idx"; }

/// "kept 20 and dropped 3 bytes, 0.54 s, lost 0.75 s at most: no footer", or why there is none.
std::string told(const core::Result<Recovery>& recovery) {
  if (!recovery) return std::string(core::name(recovery.error().code));
  std::ostringstream text;
  text << "kept " << recovery->kept_bytes << " and dropped " << recovery->dropped_bytes << " bytes, " << recovery->duration_s << " s, lost "
       << recovery->lost_s_at_most << " s at most: " << recovery->reason;
  return text.str();
}

/// The index without its last lines.
void cut_index(const Folder& folder, std::size_t lines) {
  std::string text = bytes_of(index_of(folder));
  for (std::size_t line = 0; line < lines; ++line) text.resize(text.rfind('\n', text.size() - 2) + 1);
  put_file(index_of(folder), text);
}

TEST(Recover, KilledRecording_KeepsAllAndClosesProperly) {
  const Folder folder;
  const std::string file = killed(folder);
  const std::string before = bytes_of(file);

  const auto recovery = recover(file, recovered_name(file));

  ASSERT_TRUE(recovery) << recovery.error().what;
  EXPECT_EQ(recovery->file, folder / "a.recovered.xdf");
  EXPECT_EQ(recovery->kept_bytes, before.size());
  EXPECT_EQ(recovery->dropped_bytes, 0U);
  EXPECT_EQ(recovery->reason, "no footer");
  EXPECT_NEAR(recovery->duration_s, 0.54, 1e-9);
  EXPECT_DOUBLE_EQ(recovery->lost_s_at_most, kLongestUnwrittenS + kLongestUnsynchronisedS);
  EXPECT_EQ(bytes_of(file), before) << "the original is not touched";
  EXPECT_TRUE(bytes_of(recovery->file).starts_with(before)) << "kept bit for bit";
  struct stat there {};
  ASSERT_EQ(::stat(recovery->file.c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 0222U, 0U);
  const auto checked = verify(recovery->file);
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_TRUE(checked->is_closed && checked->is_recovered && checked->has_index);
  EXPECT_EQ(checked->incomplete, "no footer");
  EXPECT_EQ(checked->sha256, recovery->sha256);
  EXPECT_EQ(checked->scans, 12U);
  EXPECT_DOUBLE_EQ(checked->lost_s_at_most, recovery->lost_s_at_most);
}

TEST(Recover, RecoveredIndex_TellsWhereSamplesStandLikeTheFirst) {
  const Folder folder;
  const std::string file = killed(folder);
  const auto original = read_index(index_of(folder)).value();
  ASSERT_TRUE(recover(file, folder / "b.xdf"));
  cut_index(folder, 7);  // the second copy has to count on from chunk to chunk
  ASSERT_TRUE(recover(file, folder / "c.xdf"));

  const auto copied = read_index(folder / "b.xdf.idx").value();
  const auto counted = read_index(folder / "c.xdf.idx").value();

  ASSERT_EQ(copied.size(), original.size() + 4);
  EXPECT_TRUE(std::equal(original.begin(), original.end(), copied.begin()));
  ASSERT_EQ(counted.size(), copied.size());
  EXPECT_EQ(counted[9].stream, 1U);  // raw, second chunk of segment 0
  EXPECT_EQ(counted[9].first_scan, 44U);
}

TEST(Recover, TornTail_IsDroppedAndCounted) {
  const Folder folder;
  const std::string file = killed(folder);
  const std::string whole = bytes_of(file);
  put_file(file, whole.substr(0, whole.size() - 3));

  const auto last = read_index(index_of(folder)).value().back();

  EXPECT_EQ(told(recover(file, folder / "b.xdf")),
            "kept " + std::to_string(last.offset) + " and dropped " + std::to_string(last.length - 3) +
                " bytes, 0.54 s, lost 0.755983 s at most: chunk torn at byte " + std::to_string(last.offset));
}

TEST(Recover, WrongChecksum_EndsTheCopyThere) {
  const Folder folder;
  const std::string file = killed(folder);
  const auto note = read_index(index_of(folder)).value()[9];
  std::string bytes = bytes_of(file);
  bytes[note.offset + note.length - 1] ^= 1;  // in a value: makes sense, but is wrong
  put_file(file, bytes);

  EXPECT_EQ(told(recover(file, folder / "b.xdf")),
            "kept 2972 and dropped 313 bytes, 0.04 s, lost 0.754213 s at most: checksum wrong at byte 2972");
}

TEST(Recover, IndexMissingTornOrLying_LosesNothing) {
  const Folder folder;
  const std::string file = killed(folder);
  const std::string index = bytes_of(index_of(folder));
  const std::string first_line = index.substr(0, index.find('\n') + 1);
  int number = 0;
  for (const std::string& other :
       {std::string(), std::string("nonsense\n"), index.substr(0, index.size() / 2), first_line + "9 9 00000000 0 0 0 0 0.0\n",
        to_line({.offset = 4, .length = 77}) + "\n" + to_line({.offset = 81, .length = 1U << 30U}) + "\n"}) {
    put_file(index_of(folder), other);
    const auto recovery = recover(file, folder / (std::to_string(++number) + ".xdf"));
    ASSERT_TRUE(recovery) << recovery.error().what;
    EXPECT_EQ(recovery->dropped_bytes, 0U) << other;
    EXPECT_DOUBLE_EQ(recovery->lost_s_at_most, kLongestUnwrittenS + kLongestUnsynchronisedS) << other;
  }
  std::filesystem::remove(index_of(folder));
  EXPECT_EQ(recover(file, folder / "b.xdf")->dropped_bytes, 0U);
}

TEST(Recover, IndexThatReachesFurther_CountsAsLost) {
  const Folder folder;
  const std::string file = killed(folder);
  put_file(file, bytes_of(file).substr(0, read_index(index_of(folder)).value().back().offset));  // the disk had not got it
  EXPECT_EQ(told(recover(file, folder / "b.xdf")), "kept 3249 and dropped 0 bytes, 0.54 s, lost 0.755983 s at most: no footer");
}

TEST(Recover, WholeOrNothingToCopy_IsRefusedOrLosesNothing) {
  const Folder folder;
  const std::string whole = closed(folder);
  EXPECT_EQ(told(recover(whole, folder / "b.xdf")), "wrong_state");
  EXPECT_FALSE(std::filesystem::exists(folder / "b.xdf.part"));
  std::filesystem::rename(whole, folder / "a.xdf.part");
  EXPECT_EQ(told(recover(folder / "a.xdf.part", folder / "b.xdf")),
            "kept 4110 and dropped 0 bytes, 0.54 s, lost 0 s at most: closed, but not renamed")
      << "closed, but not renamed";
  EXPECT_EQ(verify(folder / "b.xdf")->incomplete, "");
  XdfWriter::create(folder / "c.xdf", {{"session_id", "s"}}).value()->abandon();
  EXPECT_EQ(told(recover(folder / "c.xdf.part", folder / "d.xdf")), "kept 120 and dropped 0 bytes, 0 s, lost 0.75 s at most: no footer")
      << "killed before the first chunk";
  put_file(folder / "e.xdf.part", file_start().substr(0, 30));
  EXPECT_EQ(told(recover(folder / "e.xdf.part", folder / "f.xdf")), "data_damaged");
}

TEST(Recover, CopyExists_IsNotTouched) {
  const Folder folder;
  const std::string file = killed(folder);
  for (const char* taken : {"b.xdf", "b.xdf.part", "b.xdf.idx"}) {
    put_file(folder / taken, "precious");
    const auto recovery = recover(file, folder / "b.xdf");
    ASSERT_FALSE(recovery) << taken;
    EXPECT_EQ(recovery.error().code, core::ErrorCode::WrongState);
    EXPECT_EQ(bytes_of(folder / taken), "precious");
    std::filesystem::remove(folder / taken);
  }
}

TEST(Recover, LeftoversOfAnInterruptedRecovery_AreInNobodysWay) {
  const Folder folder;
  const std::string file = killed(folder);
  put_file(folder / "a.recovered.xdf.part", "half");
  put_file(folder / "a.recovered.xdf.idx", "half");
  EXPECT_TRUE(recover(file, recovered_name(file)));
}

TEST(Recover, Stopped_LeavesNothingBehind) {
  const Folder folder;
  const std::string file = killed(folder);
  int calls = 0;
  const auto stop_at_second = [&calls](std::uint64_t, std::uint64_t) { return ++calls < 2; };

  EXPECT_FALSE(recover(file, folder / "b.xdf", stop_at_second));

  EXPECT_EQ(calls, 2);
  for (const char* name : {"b.xdf", "b.xdf.part", "b.xdf.idx"}) EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
}

TEST(Recover, Progress_EndsAtTheWhole) {
  const Folder folder;
  std::pair<std::uint64_t, std::uint64_t> last;
  ASSERT_TRUE(recover(killed(folder), folder / "b.xdf", [&last](std::uint64_t done, std::uint64_t of) {
    last = {done, of};
    return true;
  }));
  EXPECT_EQ(last.first, last.second);
}

TEST(Recover, Name_IsBesideTheOriginal) {
  EXPECT_EQ(recovered_name("d/x.xdf.part"), "d/x.recovered.xdf");
  EXPECT_EQ(recovered_name("d/x.xdf"), "d/x.recovered.xdf");
  EXPECT_EQ(recovered_name("d/x"), "d/x.recovered.xdf");
}

TEST(Verify, AnyByteOfAClosedFileChanged_IsFound) {
  RecordProperty("requirement", "REC-5");
  const Folder folder;
  const std::string file = closed(folder);
  const std::string bytes = bytes_of(file);
  for (std::size_t position = 0; position < bytes.size(); position += kByteStep) {
    std::string changed = bytes;
    changed[position] = static_cast<char>(changed[position] ^ (1 << (position % 8)));
    put_file(file, changed);
    ASSERT_FALSE(verify(file)) << "byte " << position;
  }
}

TEST(Verify, CutAnywhere_IsFound) {
  const Folder folder;
  const std::string file = closed(folder);
  const std::string bytes = bytes_of(file);
  for (std::size_t length = 0; length < bytes.size(); length += kByteStep) {
    put_file(file, bytes.substr(0, length));
    ASSERT_FALSE(verify(file)) << length;
  }
}

TEST(Verify, CutAtAChunkWithoutAnIndex_IsNotClosed) {
  const Folder folder;
  const std::string file = closed(folder);
  const auto last = read_index(index_of(folder)).value().back();
  put_file(file, bytes_of(file).substr(0, last.offset));
  std::filesystem::remove(index_of(folder));

  const auto checked = verify(file);

  ASSERT_TRUE(checked);
  EXPECT_FALSE(checked->is_closed);
  EXPECT_FALSE(checked->has_index);
}

TEST(Verify, FooterThatMiscounts_IsFoundWithoutAnIndex) {
  const Folder folder;
  const std::string file = closed(folder);
  std::filesystem::remove(index_of(folder));
  ASSERT_TRUE(verify(file));
  for (const auto& [told, wrong] :
       {std::pair{"<sample_count>12<", "<sample_count>13<"}, std::pair{"<first_timestamp>1000<", "<first_timestamp>1001<"}}) {
    std::string bytes = bytes_of(file);
    const auto at = bytes.find(told);
    ASSERT_NE(at, std::string::npos);
    put_file(folder / "b.xdf", bytes.replace(at, std::string_view(told).size(), wrong));
    const auto checked = verify(folder / "b.xdf");
    ASSERT_FALSE(checked) << wrong;
    EXPECT_NE(checked.error().what.find("floor/raw"), std::string::npos) << checked.error().what;
  }
}

TEST(Verify, ChunkWrittenMeanwhile_IsNoFault) {
  const Folder folder;
  const auto writer = small_recording(folder / "a.xdf");
  bool is_written = false;
  const auto checked = verify(folder / "a.xdf.part", [&](std::uint64_t, std::uint64_t) {
    is_written = writer->write_boundary().has_value();  // its index line reaches beyond the size that the file had at first
    return true;
  });
  EXPECT_TRUE(is_written);
  EXPECT_TRUE(checked) << checked.error().what;
}

TEST(Verify, Growing_IsSoundButNotClosed) {
  const Folder folder;
  const auto checked = verify(killed(folder));
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_FALSE(checked->is_closed);
  EXPECT_TRUE(checked->has_index);
  EXPECT_EQ(checked->incomplete, "");
  const auto none = verify(folder / "none");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, core::ErrorCode::NotFound);
}

}  // namespace
}  // namespace dts::record::xdf_test
