// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/xdf_reader.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <limits>

#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

ReadFile read_bytes(const std::string& bytes) {
  const Folder folder;
  put_file(folder / "a.xdf", bytes);
  return read_all(folder / "a.xdf");
}

/// One sample with a stamp, then `count` - 1 without; the value bytes are the same in all.
std::string samples_content(std::uint32_t stream, const std::string& value, std::uint8_t count, double first_s) {
  std::string content = number_bytes(stream);
  content += '\x01';
  content += static_cast<char>(count);
  for (int sample = 0; sample < count; ++sample) {
    content += sample == 0 ? '\x08' : '\x00';
    if (sample == 0) put(content, first_s);
    content += value;
  }
  return content;
}

TEST(XdfReader, PrefixesOfEveryLength_AreRead) {
  for (const int length_bytes : {1, 4, 8}) {
    const auto read = read_bytes(file_start() + raw_chunk(5, std::string(kBoundaryMark), length_bytes));
    EXPECT_EQ(read.error.what, "");
    EXPECT_EQ(contents<Boundary>(read).size(), 1U);
  }
}

TEST(XdfReader, UnknownTag_IsSkipped) {
  const auto read = read_bytes(file_start() + raw_chunk(99, "whatever") + raw_chunk(5, std::string(kBoundaryMark)));
  ASSERT_EQ(contents<UnknownChunk>(read).size(), 1U);
  EXPECT_EQ(contents<UnknownChunk>(read)[0].tag, 99);
  EXPECT_EQ(contents<Boundary>(read).size(), 1U);
}

TEST(XdfReader, ForeignHeader_RateComesFromNominal) {
  const auto read = read_bytes(file_start() + header_chunk(1, "float32", " 499.5\n", "3") + header_chunk(2, "string", "0.0000", "1", "m"));
  const auto headers = contents<StreamHeader>(read);
  ASSERT_EQ(headers.size(), 2U) << read.error.what;
  EXPECT_DOUBLE_EQ(headers[0].info.rate->hz(), 499.5);
  EXPECT_EQ(headers[0].info.channels.size(), 3U);
  EXPECT_FALSE(headers[1].info.rate);
}

TEST(XdfReader, IrregularStreamWithoutStamps_KeepsTheLastTime) {
  const auto read = read_bytes(file_start() + header_chunk(1, "int8", "0", "1") + raw_chunk(3, samples_content(1, "\x05", 3, 7.5)));
  const auto samples = contents<Samples>(read);
  ASSERT_EQ(samples.size(), 1U) << read.error.what;
  EXPECT_EQ(samples[0].times_s, (std::vector<double>{7.5, 7.5, 7.5}));
  EXPECT_EQ(samples[0].values, (std::vector<double>{5, 5, 5}));
}

TEST(XdfReader, FileHeaderFacts_OfOtherProgramsToo) {
  const auto xml =
      std::string("<info><version>1.0</version><desc><place>lab</place><dts><fact name='rig'>floor</fact></dts></desc></info>");
  const auto headers = contents<FileHeader>(read_bytes(std::string(kMagic) + raw_chunk(1, xml)));
  ASSERT_EQ(headers.size(), 1U);
  EXPECT_EQ(fact(headers[0].facts, "rig"), "floor");
  EXPECT_EQ(fact(headers[0].facts, "place"), "lab");
}

TEST(XdfReader, ForeignFooter_IsReadWhereItHasNumbers) {
  const auto footer =
      raw_chunk(6, number_bytes(1) + "<info><first_timestamp>5.1</first_timestamp><last_timestamp/><sample_count>9</sample_count></info>");
  const auto footers = contents<StreamFooter>(read_bytes(file_start() + header_chunk(1, "int8", "0", "1") + footer));
  ASSERT_EQ(footers.size(), 1U);
  EXPECT_EQ(footers[0].first_time_s, 5.1);
  EXPECT_FALSE(footers[0].last_time_s);
  EXPECT_EQ(footers[0].sample_count, 9U);
}

TEST(XdfReader, NoXdf_IsRefusedAtOpening) {
  const Folder folder;
  for (const char* bytes : {"", "X", "XDF", "RIFF....", "xdf:"}) {
    put_file(folder / "a", bytes);
    const auto reader = XdfReader::open(folder / "a");
    ASSERT_FALSE(reader) << bytes;
    EXPECT_EQ(reader.error().code, core::ErrorCode::DataDamaged);
  }
}

TEST(XdfReader, NoFileAFolderOrAPipe_IsRefusedWithoutWaiting) {
  const Folder folder;
  EXPECT_EQ(XdfReader::open(folder / "none").error().code, core::ErrorCode::NotFound);
  EXPECT_EQ(XdfReader::open(folder / "").error().code, core::ErrorCode::Failed);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  EXPECT_EQ(XdfReader::open(folder / "pipe").error().code, core::ErrorCode::Failed);
}

TEST(XdfReader, OtherVersion_IsUnsupported) {
  for (const char* version : {"2.0", "", "10", "0.9", "one"}) {
    const auto read = read_bytes(file_start(version));
    EXPECT_EQ(read.error.code, core::ErrorCode::Unsupported) << version;
  }
  EXPECT_EQ(read_bytes(file_start("1.1")).error.what, "");
}

struct Hostile {
  const char* why;
  std::string tail;    ///< After a good start.
  std::string what{};  ///< Part of the message, where there could be another reason.
};
std::vector<Hostile> hostile_tails() {
  const std::string good = header_chunk(1, "double64", "100", "2");
  const std::string nan_stamp = samples_content(1, std::string(16, '\0'), 1, std::nan(""));
  return {
      {"prefix of 2 bytes", std::string("\x02\x04\x00\x05\x00", 5)},
      {"prefix of 0 bytes", std::string(8, '\0')},
      {"no room for a tag", std::string("\x01\x01\x05", 3)},
      {"length of nothing", std::string("\x01\x00", 2)},
      {"length beyond the file", std::string("\x04\xFF\xFF\x00\x00\x05\x00", 7)},
      {"length of 2^64 - 1", "\x08" + std::string(8, '\xFF') + std::string("\x05\x00", 2)},
      {"second file header", raw_chunk(1, "<info><version>1.0</version></info>")},
      {"header without a number", raw_chunk(2, "ab")},
      {"header without XML", raw_chunk(2, number_bytes(1))},
      {"header of other XML", raw_chunk(2, number_bytes(1) + "<x/>")},
      {"torn XML", raw_chunk(2, number_bytes(1) + "<info><name>")},
      {"unknown format", header_chunk(1, "float16", "100", "2")},
      {"no channels", header_chunk(1, "int8", "100", "0")},
      {"too many channels", header_chunk(1, "int8", "100", "4097")},
      {"absurdly many channels", header_chunk(1, "int8", "100", "99999999999999999999")},
      {"negative channels", header_chunk(1, "int8", "100", "-1"), "'-1'"},
      {"channels in hexadecimal", header_chunk(1, "int8", "100", "0x10")},
      {"rate nan", header_chunk(1, "int8", "nan", "1")},
      {"rate inf", header_chunk(1, "int8", "inf", "1")},
      {"negative rate", header_chunk(1, "int8", "-100", "1")},
      {"rate beyond all DAQs", header_chunk(1, "int8", "1e300", "1")},
      {"rate with a tail", header_chunk(1, "int8", "100Hz", "1")},
      {"same stream twice", good + good},
      {"samples of no stream", raw_chunk(3, samples_content(1, std::string(16, '\0'), 1, 1.0))},
      {"footer of no stream", raw_chunk(6, number_bytes(1) + "<info/>")},
      {"offset of no stream", raw_chunk(4, number_bytes(1) + std::string(16, '\0'))},
      {"offset too short", good + raw_chunk(4, number_bytes(1) + std::string(15, '\0'))},
      {"offset too long", good + raw_chunk(4, number_bytes(1) + std::string(17, '\0'))},
      {"no count", good + raw_chunk(3, number_bytes(1))},
      {"count of 3 bytes", good + raw_chunk(3, number_bytes(1) + std::string("\x03\x01\x00\x00", 4))},
      {"count of 2^63", good + raw_chunk(3, number_bytes(1) + "\x08" + std::string(7, '\0') + "\x80" + std::string(64, '\0'))},
      {"one sample too many", good + raw_chunk(3, samples_content(1, std::string(16, '\0'), 2, 1.0).replace(5, 1, "\x03")),
       "3 samples declared, but the chunk has room for 2"},
      {"one sample too few", good + raw_chunk(3, samples_content(1, std::string(16, '\0'), 2, 1.0).replace(5, 1, "\x01"))},
      {"stamp of 7 bytes", good + raw_chunk(3, samples_content(1, std::string(16, '\0'), 1, 1.0).replace(6, 1, "\x07")),
       "a time stamp of neither 0 nor 8 bytes"},
      {"stamp of 9 bytes", good + raw_chunk(3, samples_content(1, std::string(17, '\0'), 1, 1.0).replace(6, 1, "\x09")),
       "a time stamp of neither 0 nor 8 bytes"},
      {"stamp that is no number", good + raw_chunk(3, nan_stamp)},
      {"footer with a word for a count", good + raw_chunk(6, number_bytes(1) + "<info><sample_count>many</sample_count></info>"),
       "<sample_count> is not a number: 'many'"},
      {"text longer than its chunk",
       header_chunk(1, "string", "0", "1") + raw_chunk(3, samples_content(1, std::string("\x01\xFF", 2) + "ab", 1, 1.0))},
      {"text length of 2^64 - 1",
       header_chunk(1, "string", "0", "1") + raw_chunk(3, samples_content(1, "\x08" + std::string(8, '\xFF'), 1, 1.0))},
  };
}

TEST(XdfReader, HostileContent_IsRefusedWhereItStandsAndForEver) {
  const Folder folder;
  for (const auto& [why, tail, what] : hostile_tails()) {
    put_file(folder / "a.xdf", file_start() + tail);
    auto reader = XdfReader::open(folder / "a.xdf");
    ASSERT_TRUE(reader);
    auto chunk = (*reader)->next();
    while (chunk && *chunk) chunk = (*reader)->next();
    ASSERT_FALSE(chunk) << why;
    EXPECT_EQ(chunk.error().code, core::ErrorCode::DataDamaged) << why;
    EXPECT_NE(chunk.error().what.find("at byte " + std::to_string((*reader)->offset())), std::string::npos)
        << why << ": " << chunk.error().what;
    EXPECT_NE(chunk.error().what.find(what), std::string::npos) << why << ": " << chunk.error().what;
    EXPECT_EQ((*reader)->next().error(), chunk.error()) << why;
  }
}

TEST(XdfReader, MoreSamplesThanTheBytesCanHold_AreRefusedBeforeAnyIsRead) {
  const std::vector<std::pair<std::string, std::size_t>> formats{{"float32", 4}, {"double64", 8}, {"int8", 1},  {"int16", 2},
                                                                 {"int32", 4},   {"int64", 8},    {"string", 2}};
  for (const auto& [format, bytes] : formats) {
    const std::string content = samples_content(1, std::string(20 * bytes, '\x01'), 10, 1.0).replace(5, 1, "\x0B");
    const auto read = read_bytes(file_start() + header_chunk(1, format, "0", "20") + raw_chunk(3, content));
    EXPECT_NE(read.error.what.find("11 samples declared, but the chunk has room for 10"), std::string::npos)
        << format << ": " << read.error.what;
  }
}

TEST(XdfReader, ChunkOfMoreThan64MiB_IsRefusedEvenWhenItIsThere) {
  const Folder folder;
  std::string bytes = file_start();
  const auto end = bytes.size();
  bytes += std::string("\x04\x01\x00\x00\x04\x63\x00", 7);  // 2^26 + 1 bytes
  put_file(folder / "a.xdf", bytes);
  std::filesystem::resize_file(folder / "a.xdf", end + (70U << 20U));

  const auto read = read_all(folder / "a.xdf");

  EXPECT_EQ(read.error.code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(read.end, end);
}

TEST(XdfReader, ExactRateThatContradictsTheNominal_IsRefused) {
  const auto header = [](const std::string& numerator) {
    return raw_chunk(2, number_bytes(1) +
                            "<info><channel_count>1</channel_count><nominal_srate>100</nominal_srate><channel_format>int8</channel_format>"
                            "<desc><dts><rate numerator='" +
                            numerator + "' denominator='1'/></dts></desc></info>");
  };
  EXPECT_EQ(read_bytes(file_start() + header("100")).error.what, "");
  for (const char* numerator : {"101", "0", "-100", "", "x", "99999999999999999999"})
    EXPECT_EQ(read_bytes(file_start() + header(numerator)).error.code, core::ErrorCode::DataDamaged) << numerator;
}

TEST(XdfReader, FileWithoutAFileHeader_IsRefused) {
  EXPECT_EQ(read_bytes(std::string(kMagic) + raw_chunk(5, std::string(kBoundaryMark))).error.code, core::ErrorCode::DataDamaged);
}

}  // namespace
}  // namespace dts::record::xdf_test
