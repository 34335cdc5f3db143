// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/xdf_writer.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>
#include <limits>
#include <regex>

#include "record/xdf/chunk_index.h"
#include "record/xdf/header_xml.h"
#include "record/xdf/recovery.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

std::unique_ptr<XdfWriter> new_writer(const std::string& name) {
  auto writer = XdfWriter::create(name, {{"session_id", "s1"}});
  EXPECT_TRUE(writer) << writer.error().what;
  return writer ? std::move(*writer) : nullptr;
}

bool exists(const std::string& file) { return std::filesystem::exists(file); }

/// The extremes of each type, what lies beyond them, and what is no number.
TEST(XdfWriter, Values_ComeBackAsTheNearestTheTypeHolds) {
  using enum ValueType;
  for (const ValueType type : {Float32, Double64, Int8, Int16, Int32, Int64}) {
    SCOPED_TRACE(static_cast<int>(type));
    const Folder folder;
    const std::string name = folder / "a.xdf";
    auto writer = new_writer(name);
    const double infinity = std::numeric_limits<double>::infinity();
    const std::vector<double> values = {0, 1, -1, 127, -128, 1.5, 40000, -1e300, 1e300, infinity, -infinity, std::nan("")};
    const auto stream = writer->add_stream(regular_stream("floor/raw", {"a_v", "b_v"}, rate_of(100), type));
    ASSERT_TRUE(writer->write_samples(stream, 10.0, values, {}));
    ASSERT_TRUE(writer->close());
    const auto samples = contents<Samples>(read_all(name));
    ASSERT_EQ(samples.size(), 1U);
    ASSERT_EQ(samples[0].values.size(), values.size());
    const auto expected = [type](double value) {
      if (type == ValueType::Double64) return value;
      if (type == ValueType::Float32)
        return std::abs(value) == 1e300 ? std::copysign(double{std::numeric_limits<float>::max()}, value) : value;
      if (std::isnan(value)) return 0.0;
      const double highest = type == ValueType::Int8    ? 127.0
                             : type == ValueType::Int16 ? 32767.0
                             : type == ValueType::Int32 ? 2147483647.0
                                                        : 9223372036854775807.0;
      const double lowest = type == ValueType::Int64 ? -highest : -highest - 1.0;
      return std::clamp(std::round(value), lowest, highest);
    };
    for (std::size_t index = 0; index < values.size(); ++index) {
      const double wanted = expected(values[index]);
      EXPECT_TRUE(samples[0].values[index] == wanted || (std::isnan(wanted) && std::isnan(samples[0].values[index])))
          << values[index] << " became " << samples[0].values[index];
    }
  }
}

TEST(XdfWriter, RegularStream_TimesCountOnExactlyFromTheFirst) {
  const Folder folder;
  auto writer = new_writer(folder / "a.xdf");
  const auto rate = rate_of(1'000'000, 999);  // no whole number of hertz
  const auto stream = writer->add_stream(regular_stream("floor/raw", {"a_v"}, rate));
  const std::vector<double> values(300, 1.0);
  ASSERT_TRUE(writer->write_samples(stream, 1e6, values, {}));
  ASSERT_TRUE(writer->close());

  const auto samples = contents<Samples>(read_all(folder / "a.xdf"));

  ASSERT_EQ(samples.size(), 1U);
  ASSERT_EQ(samples[0].times_s.size(), 300U);
  EXPECT_TRUE(samples[0].has_first_time);
  for (std::size_t sample = 0; sample < 300; ++sample)
    EXPECT_DOUBLE_EQ(samples[0].times_s[sample], 1e6 + static_cast<double>(sample) * 999.0 / 1e6);
}

TEST(XdfWriter, StreamInfo_ComesBackWhole) {
  const Folder folder;
  StreamInfo info = regular_stream("floor/raw", {"w1_v"}, rate_of(1'000'000, 3003));
  info.channels[0] = {.label = "w<1>\n\"&]]>",
                      .unit = "V",
                      .type = "Voltage",
                      .device_channel = 3,
                      .minimum = -10.0,
                      .maximum = 10.0,
                      .resolution = 20.0 / 65536,
                      .is_sensor = true,
                      .is_marker = true};
  info.delay_ns = 13'000'000;
  info.facts = {{"first", "a\r\n\tb"}, {"second", " "}, {"third", ""}, {"first", "again"}};
  auto writer = new_writer(folder / "a.xdf");
  const auto stream = writer->add_stream(info);
  writer->add_fact(stream, "late", "µ");
  const std::vector<double> one = {1.0};
  ASSERT_TRUE(writer->write_samples(stream, 1.0, one, {}));
  ASSERT_TRUE(writer->close());

  const auto headers = contents<StreamHeader>(read_all(folder / "a.xdf"));

  info.facts.emplace_back("late", "µ");
  ASSERT_EQ(headers.size(), 1U);
  EXPECT_EQ(headers[0].info, info);
}

TEST(XdfWriter, TextsXmlForbids_AreReplacedNotRefused) {
  const StreamInfo info{.name = std::string("a\0b\x01", 4), .content = "\xC3\x28", .value_type = ValueType::Text, .channels = {{}}};

  const auto read = stream_info_of_xml(stream_header_xml(info, {}));

  ASSERT_TRUE(read) << read.error().what;
  EXPECT_EQ(read->name, "a\uFFFDb\uFFFD");
  EXPECT_EQ(read->content, "\uFFFD(");
}

TEST(XdfWriter, TimedNumbersAndTexts_ComeBack) {
  const Folder folder;
  auto writer = new_writer(folder / "a.xdf");
  const auto quality = writer->add_stream(quality_stream(2));
  const auto events = writer->add_stream(events_stream());
  const std::vector<double> times_s = {1.5, 1.25, 9.0};
  const std::vector<double> values = {1, 2, 3, 4, 5, 6};
  const std::vector<std::pair<double, std::string>> texts = {{1.0, ""}, {2.0, std::string(300, 'x')}, {3.0, std::string("\0\xFF", 2)}};
  ASSERT_TRUE(writer->write_timed(quality, times_s, values, {}));
  ASSERT_TRUE(writer->write_texts(events, texts, {}));
  ASSERT_TRUE(writer->write_clock_offset(events, 4.5, -0.25));
  EXPECT_EQ(writer->sample_count(quality), 3U);
  ASSERT_TRUE(writer->close());

  const auto read = read_all(folder / "a.xdf");

  const auto samples = contents<Samples>(read);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].times_s, times_s);
  EXPECT_EQ(samples[0].values, values);
  EXPECT_EQ(samples[1].times_s, (std::vector<double>{1.0, 2.0, 3.0}));
  EXPECT_EQ(samples[1].texts, (std::vector<std::string>{"", std::string(300, 'x'), std::string("\0\xFF", 2)}));
  const auto offsets = contents<ClockOffset>(read);
  ASSERT_EQ(offsets.size(), 1U);
  EXPECT_EQ(offsets[0].stream, events);
  EXPECT_EQ(offsets[0].stream_time_s, 4.5);
  EXPECT_EQ(offsets[0].offset_s, -0.25);
}

TEST(XdfWriter, Close_RenamesProtectsAndSumsUp) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  ASSERT_TRUE(writer);
  EXPECT_FALSE(exists(folder / "a.xdf"));
  EXPECT_TRUE(exists(folder / "a.xdf.part"));

  const auto closed = writer->close();

  ASSERT_TRUE(closed) << closed.error().what;
  EXPECT_EQ(closed->file, folder / "a.xdf");
  EXPECT_EQ(closed->bytes, std::filesystem::file_size(folder / "a.xdf"));
  EXPECT_FALSE(exists(folder / "a.xdf.part"));
  struct stat there {};
  ASSERT_EQ(::stat((folder / "a.xdf").c_str(), &there), 0);
  EXPECT_EQ(there.st_mode & 07777U, 0440U);
  const auto checked = verify(folder / "a.xdf");
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_EQ(checked->sha256, closed->sha256);  // one counted along while writing, the other from the file
  EXPECT_TRUE(checked->is_closed);
  EXPECT_TRUE(checked->has_index);
  const auto footers = contents<StreamFooter>(read_all(folder / "a.xdf"));
  ASSERT_EQ(footers.size(), 4U);
  EXPECT_EQ(footers[0].sample_count, 12U);
  EXPECT_EQ(footers[0].first_time_s, 1000.0);
  EXPECT_NEAR(*footers[0].last_time_s, 1000.53, 1e-9);
}

TEST(XdfWriter, IndexLines_TellWhereSamplesStand) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  ASSERT_TRUE(writer && writer->close());

  const auto notes = read_index(folder / "a.xdf.idx");

  ASSERT_TRUE(notes);
  const auto read = read_all(folder / "a.xdf");
  ASSERT_EQ(notes->size(), read.chunks.size());
  for (std::size_t index = 0; index < notes->size(); ++index) {
    EXPECT_EQ((*notes)[index].offset, read.chunks[index].offset);
    EXPECT_EQ((*notes)[index].length, read.chunks[index].length);
  }
  const auto& raw = (*notes)[4];  // file header, events header, event, raw header, raw samples
  EXPECT_EQ(raw.stream, 1U);
  EXPECT_EQ(raw.first_scan, 40U);
  EXPECT_EQ(raw.samples, 4U);
  EXPECT_EQ(raw.time_s, 1000.0);
}

/// Streams begin at different times, and need not have the same offsets.
TEST(XdfWriter, EachFooter_HasTheClockOffsetsOfItsStream) {
  const Folder folder;
  auto writer = new_writer(folder / "a.xdf");
  std::vector<std::uint32_t> streams;
  const std::vector<double> value = {1};
  const auto begin_stream = [&] {
    streams.push_back(writer->add_stream(regular_stream("floor/" + std::to_string(streams.size()), {"a_v"}, rate_of(100))));
    EXPECT_TRUE(writer->write_samples(streams.back(), 1.0, value, {}));
  };
  const auto note = [&](std::size_t stream, double time_s, double offset_s) {
    EXPECT_TRUE(writer->write_clock_offset(streams[stream], time_s, offset_s));
  };
  begin_stream();
  begin_stream();
  note(0, 1, 0.5);
  note(1, 1, 0.5);
  begin_stream();
  for (const std::size_t stream : {0, 1, 2}) note(stream, 2, 0.5);
  note(2, 3, 0.25);
  note(0, 4, 0.25);
  note(2, 4, 0.25);
  ASSERT_TRUE(writer->close());

  const std::string bytes = bytes_of(folder / "a.xdf");
  std::vector<std::string> listed;
  for (std::size_t at = 0; (at = bytes.find("<clock_offsets>", at)) != std::string::npos;) {
    const std::size_t end = bytes.find("</clock_offsets>", at);
    listed.push_back(std::regex_replace(bytes.substr(at, end - at), std::regex("(<[^>]*>)+"), " "));
    at = end;
  }
  EXPECT_EQ(listed, (std::vector<std::string>{" 1 0.5 2 0.5 4 0.25 ", " 1 0.5 2 0.5 ", " 2 0.5 3 0.25 4 0.25 "}));
}

TEST(XdfWriter, StreamWithoutSamples_IsNotInTheFile) {
  const Folder folder;
  auto writer = new_writer(folder / "a.xdf");
  const auto stream = writer->add_stream(regular_stream("floor/raw", {"a_v"}, rate_of(100)));
  ASSERT_TRUE(writer->write_samples(stream, 1.0, {}, {}));
  EXPECT_FALSE(writer->write_clock_offset(stream, 1.0, 0.0));
  ASSERT_TRUE(writer->close());

  EXPECT_EQ(read_all(folder / "a.xdf").chunks.size(), 1U);
}

TEST(XdfWriter, WrongCalls_AreRefusedAndBreakNothing) {
  const Folder folder;
  auto writer = new_writer(folder / "a.xdf");
  const auto stream = writer->add_stream(regular_stream("floor/raw", {"a_v", "b_v"}, rate_of(100)));
  const auto events = writer->add_stream(events_stream());
  const std::vector<double> two = {1.0, 2.0};
  const std::vector<double> three = {1.0, 2.0, 3.0};
  const std::vector<std::pair<double, std::string>> texts = {{std::nan(""), "x"}};

  EXPECT_FALSE(writer->write_samples(stream, 1.0, three, {}));
  EXPECT_FALSE(writer->write_samples(stream, std::nan(""), two, {}));
  EXPECT_FALSE(writer->write_samples(events, 1.0, two, {}));
  EXPECT_FALSE(writer->write_samples(9, 1.0, two, {}));
  EXPECT_FALSE(writer->write_samples(0, 1.0, two, {}));
  EXPECT_FALSE(writer->write_texts(events, texts, {}));
  EXPECT_FALSE(writer->write_timed(stream, two, two, {}));

  EXPECT_TRUE(writer->write_samples(stream, 1.0, two, {}));
  EXPECT_TRUE(writer->close());
}

TEST(XdfWriter, AnyOfItsFilesExists_CreateRefusesAndTouchesNothing) {
  for (const char* taken : {"a.xdf", "a.xdf.part", "a.xdf.idx"}) {
    const Folder folder;
    put_file(folder / taken, "precious");

    const auto writer = XdfWriter::create(folder / "a.xdf", {});

    ASSERT_FALSE(writer) << taken;
    EXPECT_EQ(writer.error().code, core::ErrorCode::WrongState);
    EXPECT_EQ(bytes_of(folder / taken), "precious");
    for (const char* other : {"a.xdf", "a.xdf.part", "a.xdf.idx"}) EXPECT_EQ(exists(folder / other), std::string_view(other) == taken);
  }
}

TEST(XdfWriter, FolderMissing_SaysSo) {
  const Folder folder;
  const auto writer = XdfWriter::create(folder / "none/a.xdf", {});
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, core::ErrorCode::NotFound);
}

TEST(XdfWriter, NameTakenWhileWriting_IsNeverOverwritten) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  put_file(folder / "a.xdf", "precious");

  const auto closed = writer->close();

  ASSERT_FALSE(closed);
  EXPECT_EQ(bytes_of(folder / "a.xdf"), "precious");
  EXPECT_TRUE(exists(folder / "a.xdf.part"));
}

TEST(XdfWriter, CloseIncompleteAfterAFailedClose_WritesFootersOnce) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  put_file(folder / "a.xdf", "in the way");
  ASSERT_FALSE(writer->close());
  std::filesystem::remove(folder / "a.xdf");

  const auto closed = writer->close_incomplete("disk full");

  ASSERT_TRUE(closed) << closed.error().what;
  const auto checked = verify(folder / "a.xdf");
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_EQ(checked->incomplete, "disk full");
  EXPECT_EQ(checked->sha256, closed->sha256);
  EXPECT_TRUE(checked->has_index);
  EXPECT_EQ(contents<StreamFooter>(read_all(folder / "a.xdf")).size(), 4U);
}

/// A full disk, as far as the writer can tell: no file of this process grows beyond the limit. The write that reaches it is a short one.
class FullDisk {
 public:
  explicit FullDisk(std::uint64_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    rlimit full = before_;
    full.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

TEST(XdfWriter, DiskFull_TornChunkIsCutOffAndTheRestCanStillBeClosed) {
  RecordProperty("requirement", "REC-4");
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  const std::uint64_t whole = writer->bytes();
  const std::vector<double> values(2000, 1.0);
  {
    const FullDisk full(whole + 100);
    const auto first = writer->write_samples(1, 1001.0, values, {});
    ASSERT_FALSE(first);
    EXPECT_EQ(std::filesystem::file_size(folder / "a.xdf.part"), whole) << "the torn chunk is cut off";
    EXPECT_EQ(writer->write_samples(1, 1001.0, values, {}).error(), first.error());
    EXPECT_EQ(writer->synchronise().error(), first.error());
    EXPECT_EQ(writer->close().error(), first.error());
    EXPECT_FALSE(writer->close_incomplete("disk full")) << "no room for footers";
    EXPECT_EQ(std::filesystem::file_size(folder / "a.xdf.part"), whole);
  }

  const auto closed = writer->close_incomplete("disk full");  // somebody made room

  ASSERT_TRUE(closed) << closed.error().what;
  EXPECT_EQ(writer->sample_count(1), 12U);
  const auto checked = verify(folder / "a.xdf");
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_EQ(checked->incomplete, "disk full");
  EXPECT_EQ(checked->sha256, closed->sha256);
  EXPECT_TRUE(checked->has_index);
}

TEST(XdfWriter, DiskFullAtAStreamsFirstSamples_LeavesNoHeaderWithoutSamples) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  const auto late = writer->add_stream(regular_stream("floor/late", {"a_v"}, rate_of(100)));
  const std::vector<double> values(2000, 1.0);
  {
    const FullDisk full(writer->bytes() + 2000);  // room for the header
    ASSERT_FALSE(writer->write_samples(late, 1001.0, values, {}));
  }
  ASSERT_TRUE(writer->close_incomplete("disk full"));

  EXPECT_EQ(contents<StreamHeader>(read_all(folder / "a.xdf")).size(), 4U);
}

TEST(XdfWriter, DiskFullForTheIndexOnly_IndexIsMadeWholeAtClose) {
  const Folder folder;
  auto writer = XdfWriter::create(folder / "a.xdf", {});
  ASSERT_TRUE(writer);
  const auto stream = (*writer)->add_stream(regular_stream("r", {"a"}, rate_of(100), ValueType::Int8));
  const std::vector<double> one = {1.0};
  std::uint64_t index_bytes = 0;
  for (int chunk = 0; index_bytes <= (*writer)->bytes(); ++chunk) {  // until the index is the longer of the two
    ASSERT_TRUE((*writer)->write_samples(stream, 1e9 + chunk, one, {.segment = 4'000'000'000U, .first_scan = {1ULL << 60U}}));
    index_bytes = std::filesystem::file_size(folder / "a.xdf.idx");
  }
  {
    const FullDisk full(index_bytes + 10);
    ASSERT_FALSE((*writer)->write_samples(stream, 2e9, one, {}));
  }
  EXPECT_EQ(std::filesystem::file_size(folder / "a.xdf.idx"), index_bytes);
  ASSERT_TRUE((*writer)->close_incomplete("disk full"));

  const auto checked = verify(folder / "a.xdf");

  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_TRUE(checked->has_index);
}

TEST(XdfWriter, Closed_EveryCallFails) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  ASSERT_TRUE(writer->close());

  EXPECT_FALSE(writer->write_samples(1, 1.0, std::vector{1.0, 2.0}, {}));
  EXPECT_FALSE(writer->write_boundary());
  EXPECT_FALSE(writer->synchronise());
  EXPECT_FALSE(writer->close());
  EXPECT_FALSE(writer->close_incomplete("late"));
  const int other = ::open("/dev/null", O_RDONLY);  // gets the number of its first descriptor
  writer.reset();
  EXPECT_EQ(::close(other), 0) << "closed by somebody else";
}

TEST(XdfWriter, Abandon_LeavesWholeChunksUnderTheWorkingName) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  const auto bytes = writer->bytes();
  writer->abandon();

  const auto read = read_all(folder / "a.xdf.part");

  EXPECT_EQ(read.error.what, "");
  EXPECT_EQ(read.end, bytes);
  EXPECT_FALSE(exists(folder / "a.xdf"));
}

}  // namespace
}  // namespace dts::record::xdf_test
