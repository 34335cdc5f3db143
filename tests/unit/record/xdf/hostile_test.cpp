// SPDX-License-Identifier: Apache-2.0
// Whatever the bytes: no crash, no memory that the file cannot justify, and what is whole is kept.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>

#include "record/recording.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/recovery.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

/// Everything that reads, over one file. Returns the items that came out.
std::size_t read_with_everything(const Folder& folder, const std::string& bytes) {
  const std::string file = folder / "h.xdf";
  const std::string copy = folder / "h.recovered.xdf";
  put_file(file, bytes);
  std::filesystem::remove(copy);
  std::filesystem::remove(copy + ".idx");
  (void)read_all(file);
  (void)verify(file);
  if (recover(file, copy)) {
    const auto checked = verify(copy);
    EXPECT_TRUE(checked && checked->is_closed) << "a recovered copy is sound";
    // The facts stand in the streams' footers: a file without any stream cannot say it.
    EXPECT_TRUE(checked && (checked->is_recovered || checked->scans == 0));
  }
  const auto recording = Recording::open(file);
  std::size_t items = 0;
  while (recording) {
    const auto item = (*recording)->next();
    EXPECT_TRUE(item) << "what the first pass could read, the second can";
    if (!item || !*item) break;
    ++items;
  }
  return items;
}

std::string small_bytes(const Folder& folder) {
  EXPECT_TRUE(small_recording(folder / "a.xdf")->close());
  return bytes_of(folder / "a.xdf");
}

TEST(HostileFile, CutAtEveryByte_AllWholeChunksAreKept) {
  const Folder folder;
  const std::string bytes = small_bytes(folder);
  const auto notes = read_index(folder / "a.xdf.idx").value();
  for (std::size_t length = 0; length <= bytes.size(); length += kByteStep) {
    put_file(folder / "c.xdf", bytes.substr(0, length));
    std::uint64_t whole_end = 4;
    std::size_t whole = 0;
    for (; whole < notes.size() && notes[whole].offset + notes[whole].length <= length; ++whole)
      whole_end = notes[whole].offset + notes[whole].length;

    const auto read = read_all(folder / "c.xdf");
    ASSERT_EQ(read.chunks.size(), whole) << length;
    ASSERT_EQ(read.end, length >= 4 ? whole_end : 0) << length;
    ASSERT_EQ(read.error.what.empty(), length >= 4 && length == whole_end) << length;
  }
}

TEST(HostileFile, RecoveredFromACutAtEveryByte_HasAllWholeSamples) {
  const Folder folder;
  const std::string bytes = small_bytes(folder);
  const auto notes = read_index(folder / "a.xdf.idx").value();
  for (std::size_t length = notes[0].offset + notes[0].length; length < bytes.size(); length += kByteStep) {
    std::uint64_t samples = 0;
    for (const auto& note : notes)
      if (note.offset + note.length <= length) samples += note.samples;
    put_file(folder / "c.xdf.part", bytes.substr(0, length));
    std::filesystem::remove(folder / "d.xdf");
    std::filesystem::remove(folder / "d.xdf.idx");

    const auto recovery = recover(folder / "c.xdf.part", folder / "d.xdf");

    ASSERT_TRUE(recovery) << length << ": " << recovery.error().what;
    std::uint64_t kept = 0;
    for (const auto& chunk : contents<Samples>(read_all(folder / "d.xdf"))) kept += chunk.times_s.size();
    ASSERT_EQ(kept, samples) << length;
    ASSERT_TRUE(verify(folder / "d.xdf")) << length;
  }
}

TEST(HostileFile, CutAtEveryByte_NobodyCrashes) {
  const Folder folder;
  const std::string bytes = small_bytes(folder);
  std::size_t before = 0;
  for (std::size_t length = 0; length <= bytes.size(); length += kByteStep) {
    const std::size_t items = read_with_everything(folder, bytes.substr(0, length));
    ASSERT_GE(items, before) << "a longer file has no fewer items";
    before = items;
  }
}

TEST(HostileFile, EveryByteChanged_NobodyCrashes) {
  RecordProperty("requirement", "REC-8");
  const Folder folder;
  const std::string bytes = small_bytes(folder);
  for (std::size_t position = 0; position < bytes.size(); position += kByteStep) {
    std::string changed = bytes;
    changed[position] = static_cast<char>(changed[position] ^ (position % 3 == 0 ? '\xFF' : position % 3 == 1 ? '\x01' : '\x80'));
    read_with_everything(folder, changed);
  }
}

TEST(HostileFile, RandomBytesAfterAGoodStart_NobodyCrashes) {
  const Folder folder;
  std::mt19937_64 random(7);
  const std::string start = file_start() + header_chunk(1, "int16", "100", "1") + header_chunk(2, "string", "0", "2");
  for (int round = 0; round < 500; ++round) {
    std::string noise(random() % 200, '\0');
    for (char& byte : noise) byte = static_cast<char>(random());
    const bool is_framed = round % 2 == 0;
    const auto tag = static_cast<std::uint16_t>(random() % 7);
    const auto stream = static_cast<std::uint32_t>(random() % 3);
    read_with_everything(folder, is_framed ? start + raw_chunk(tag, number_bytes(stream) + noise) : "XDF:" + noise);
  }
}

/// Peak memory that reading a file takes beyond what the process has anyway: measured in a child of its own, since a peak never falls.
long peak_mib_of_reading(const std::string& file) {
  const pid_t child = ::fork();
  if (child == 0) {
    rusage before{};
    ::getrusage(RUSAGE_SELF, &before);
    (void)verify(file);
    (void)Recording::open(file);
    rusage after{};
    ::getrusage(RUSAGE_SELF, &after);
    ::_exit(static_cast<int>(std::min<long>((after.ru_maxrss - before.ru_maxrss) / 1024, 255)));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(HostileFile, DeclaredSizesThatAreNotThere_TakeNoMemory) {
  RecordProperty("requirement", "REC-8");
  const Folder folder;
  const std::string start = file_start() + header_chunk(1, "double64", "100", "4096") + header_chunk(2, "string", "0", "1");
  const std::string eight_bytes = "\x08" + std::string(6, '\xFF') + std::string(2, '\0');
  const std::string sixty_mib = std::string("\x04\x00\x00\xC0\x03", 5);
  for (const std::string& tail :
       {raw_chunk(3, number_bytes(1) + eight_bytes), raw_chunk(3, number_bytes(2) + eight_bytes),
        raw_chunk(3, number_bytes(2) + "\x01\x01" + std::string(1, '\0') + eight_bytes), eight_bytes + "\x03", sixty_mib + "\x03"}) {
    put_file(folder / "a.xdf", start + tail);
    const long peak_mib = peak_mib_of_reading(folder / "a.xdf");
    EXPECT_GE(peak_mib, 0);
    EXPECT_LT(peak_mib, 16);
  }
}

}  // namespace
}  // namespace dts::record::xdf_test
