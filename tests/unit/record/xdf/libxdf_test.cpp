// SPDX-License-Identifier: Apache-2.0
// Another's reader opens what we write, and we read what it accepts. libxdf crashes on files that are not sound: it gets sound ones only.
#include <gtest/gtest.h>
#include <xdf.h>

#include <sstream>
#include <streambuf>

#include "record/xdf/recovery.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kIsTooStrict = true;  // libxdf makes std::strings of buffers without a terminating zero
#else
constexpr bool kIsTooStrict = false;
#endif

/// It talks to std::cout.
class Silence {
 public:
  Silence() : before_(std::cout.rdbuf(sink_.rdbuf())) {}
  ~Silence() { std::cout.rdbuf(before_); }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  std::ostringstream sink_;
  std::streambuf* before_;
};

std::unique_ptr<Xdf> load(const std::string& file) {
  const Silence silence;
  auto xdf = std::make_unique<Xdf>();
  EXPECT_EQ(xdf->load_xdf(file), 0);
  return xdf;
}

const Xdf::Stream* find(const Xdf& xdf, const std::string& name) {
  for (const auto& stream : xdf.streams)
    if (stream.info.name == name) return &stream;
  return nullptr;
}

void expect_small_recording(const Xdf& xdf) {
  const auto* raw = find(xdf, "floor/raw");
  ASSERT_NE(raw, nullptr);
  EXPECT_EQ(raw->info.nominal_srate, 100.0);
  EXPECT_EQ(raw->info.channel_format, "double64");
  ASSERT_EQ(raw->info.channels.size(), 2U);
  EXPECT_EQ(raw->info.channels[0].at("label"), "w1_v");
  EXPECT_EQ(raw->info.channels[1].at("unit"), "V");
  EXPECT_EQ(raw->info.channels[1].at("type"), "Voltage");
  ASSERT_EQ(raw->time_stamps.size(), 12U);
  // libxdf applies the clock offset of -1.5 us that the file tells.
  for (std::size_t scan = 0; scan < 8; ++scan)
    EXPECT_NEAR(raw->time_stamps[scan], 1000.0 - 1.5e-6 + 0.01 * static_cast<double>(scan), 1e-9);
  for (std::size_t scan = 8; scan < 12; ++scan)
    EXPECT_NEAR(raw->time_stamps[scan], 999.92 + 0.5 - 1.5e-6 + 0.01 * static_cast<double>(scan), 1e-9);
  EXPECT_EQ(raw->time_series[1][2], -3.0F);
  EXPECT_EQ(raw->info.sample_count, 12);
  const auto* cop = find(xdf, "floor/cop");
  ASSERT_NE(cop, nullptr);
  EXPECT_NEAR(cop->time_stamps[1], 1000.02, 1e-9);
  const auto* quality = find(xdf, "floor/quality");
  ASSERT_NE(quality, nullptr);
  EXPECT_EQ(quality->info.nominal_srate, 0.0);
  EXPECT_EQ(quality->time_series[0][0], 3.0F);
  ASSERT_EQ(xdf.eventMap.size(), 2U);
  EXPECT_EQ(xdf.eventMap[0].first.first, R"({"event":"segment","segment":0,"scan":40})");
  EXPECT_EQ(xdf.eventMap[1].first.second, 1000.5);
}

TEST(Libxdf, OurRecording_OpensWithLabelsUnitsRatesTimesAndEvents) {
  RecordProperty("requirement", "REC-1");
  if (kIsTooStrict) GTEST_SKIP() << "libxdf does not run under the address sanitizer";
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  ASSERT_TRUE(writer && writer->close());

  expect_small_recording(*load(folder / "a.xdf"));
}

TEST(Libxdf, RecoveredCopy_OpensLikeTheOriginal) {
  if (kIsTooStrict) GTEST_SKIP() << "libxdf does not run under the address sanitizer";
  const Folder folder;
  small_recording(folder / "a.xdf")->abandon();
  ASSERT_TRUE(recover(folder / "a.xdf.part", folder / "a.recovered.xdf"));

  expect_small_recording(*load(folder / "a.recovered.xdf"));
}

TEST(Libxdf, RegularStreamCutBeforeItsSamples_RecoveredCopyLoads) {
  if (kIsTooStrict) GTEST_SKIP() << "libxdf does not run under the address sanitizer";
  const Folder folder;
  put_file(folder / "a.xdf", file_start() + header_chunk(1, "float32", "100", "1") + header_chunk(2, "string", "0", "1", "markers"));
  ASSERT_TRUE(recover(folder / "a.xdf", folder / "b.xdf"));

  const auto xdf = load(folder / "b.xdf");

  EXPECT_EQ(find(*xdf, "EEG"), nullptr);
  EXPECT_NE(find(*xdf, "markers"), nullptr);
}

/// Long grids: what libxdf adds up sample by sample stays on ours, since every chunk has a time stamp.
TEST(Libxdf, MinuteAtAnOddRate_TimesStayOnTheGrid) {
  if (kIsTooStrict) GTEST_SKIP() << "libxdf does not run under the address sanitizer";
  const Folder folder;
  const auto rate = rate_of(10'000'000, 6667);  // 1499.925 Hz
  auto writer = XdfWriter::create(folder / "a.xdf", {});
  ASSERT_TRUE(writer);
  const auto stream = (*writer)->add_stream(regular_stream("chair/raw", {"a_v"}, rate));
  const std::vector<double> values(375, 1.0);
  for (std::uint64_t chunk = 0; chunk < 240; ++chunk)
    ASSERT_TRUE((*writer)->write_samples(stream, 500.0 + static_cast<double>(rate.time_ns({chunk * 375})) * 1e-9, values, {}));
  ASSERT_TRUE((*writer)->close());

  const auto xdf = load(folder / "a.xdf");

  const auto* raw = find(*xdf, "chair/raw");
  ASSERT_NE(raw, nullptr);
  ASSERT_EQ(raw->time_stamps.size(), 240U * 375U);
  for (std::size_t scan = 0; scan < raw->time_stamps.size(); scan += 7)
    ASSERT_NEAR(raw->time_stamps[scan], 500.0 + static_cast<double>(scan) * 6667.0 / 1e7, 1.1e-9) << scan;
}

/// A file as other programs write it, with prefixes of all lengths and stamps here and there: both readers must agree on it.
std::string foreign_file() {
  std::string bytes = file_start() + header_chunk(7, "int16", "250", "2") + header_chunk(8, "string", "0", "1", "markers");
  std::string content = number_bytes(7);
  content += std::string("\x04\x03\x00\x00\x00", 5);  // three samples, count in four bytes
  for (int sample = 0; sample < 3; ++sample) {
    put(content, std::uint8_t{sample == 0 ? std::uint8_t{8} : std::uint8_t{0}});
    if (sample == 0) put(content, 50.0);
    put(content, static_cast<std::int16_t>(sample));
    put(content, static_cast<std::int16_t>(-1000 * sample));
  }
  bytes += raw_chunk(3, content, 8);
  content = number_bytes(8) + std::string("\x01\x01\x08", 3);
  put(content, 50.004);
  content += std::string("\x04\x05\x00\x00\x00press", 10);
  bytes += raw_chunk(3, content, 1);
  content = number_bytes(7) + std::string("\x08\x01\x00\x00\x00\x00\x00\x00\x00\x00\x07\x00\xFF\xFF", 14);
  return bytes + raw_chunk(3, content, 4);  // one sample without a stamp: goes on from the chunk before
}

TEST(Libxdf, ForeignFile_BothReadersSayTheSame) {
  const Folder folder;
  put_file(folder / "a.xdf", foreign_file());

  const auto ours = contents<Samples>(read_all(folder / "a.xdf"));

  ASSERT_EQ(ours.size(), 3U);
  EXPECT_EQ(ours[0].values, (std::vector<double>{0, 0, 1, -1000, 2, -2000}));
  EXPECT_EQ(ours[1].texts, std::vector<std::string>{"press"});
  EXPECT_EQ(ours[2].values, (std::vector<double>{7, -1}));
  EXPECT_FALSE(ours[2].has_first_time);
  EXPECT_NEAR(ours[2].times_s[0], 50.012, 1e-12);
  if (kIsTooStrict) return;
  const auto theirs = load(folder / "a.xdf");
  const auto* stream = find(*theirs, "EEG");
  ASSERT_NE(stream, nullptr);
  ASSERT_EQ(stream->time_stamps.size(), 4U);
  for (std::size_t sample = 0; sample < 3; ++sample) EXPECT_NEAR(stream->time_stamps[sample], ours[0].times_s[sample], 1e-12);
  EXPECT_NEAR(stream->time_stamps[3], ours[2].times_s[0], 1e-12);
  EXPECT_EQ(stream->time_series[1][2], -2000.0F);
  EXPECT_EQ(theirs->eventMap.at(0).first.first, "press");
}

}  // namespace
}  // namespace dts::record::xdf_test
