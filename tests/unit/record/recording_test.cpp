// SPDX-License-Identifier: Apache-2.0
#include "record/recording.h"

#include <gtest/gtest.h>

#include "record/xdf/recovery.h"
#include "unit/record/recording_text.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

std::unique_ptr<Recording> open(const std::string& file) {
  auto recording = Recording::open(file);
  EXPECT_TRUE(recording) << recording.error().what;
  return recording ? std::move(*recording) : nullptr;
}

std::unique_ptr<Recording> small(const Folder& folder) {
  auto writer = small_recording(folder / "a.xdf");
  EXPECT_TRUE(writer && writer->close());
  return open(folder / "a.xdf");
}

TEST(Recording, Overview_KnowsStreamsSessionAndCounts) {
  const Folder folder;
  const auto recording = small(folder);

  ASSERT_EQ(recording->streams().size(), 4U);
  EXPECT_EQ(recording->session(), floor_session());
  EXPECT_EQ(recording->damage(), "");
  const auto raw = recording->find_stream("raw");
  ASSERT_TRUE(raw);
  EXPECT_EQ(recording->find_stream("floor/raw"), raw);
  EXPECT_FALSE(recording->find_stream("floor"));
  EXPECT_EQ(recording->sample_count(*raw), 12U);
  EXPECT_EQ(recording->sample_count(*recording->find_stream("cop")), 4U);
  EXPECT_EQ(recording->sample_count(99), 0U);
  EXPECT_NEAR(recording->duration_s(), 0.54, 1e-12);
  EXPECT_EQ(recording->losses().total().gaps, 1U);
}

/// The small recording without its last chunk. It starts at raw scan 40; cop, of half the rate, counts its own: 20.
const std::string kSmallItems =  // NOLINT(cert-err58-cpp)
    "event @1000 {\"scan\":\"40\",\"segment_start\":{}}\n"
    "raw 0:40 @1000 1 -1 2 -2 3 -3 4 -4\n"
    "cop 0:20 @1000 0.5 0.25\n"
    "quality 0:42 @1000.02 3\n"
    "raw 0:44 @1000.04 1 -1 2 -2 3 -3 4 -4\n"
    "offset @1000.05 raw -1.5e-06\n"
    "event @1000.5 {\"segment\":1,\"segment_start\":{}}\n"
    "raw 1:0 @1000.5 1 -1 2 -2 3 -3 4 -4\n";

TEST(Recording, Items_ComeAsTheyWereWrittenAndAgainAfterRewind) {
  const Folder folder;
  const auto recording = small(folder);
  const std::string once = items_text(*recording);
  EXPECT_EQ(once, kSmallItems + "cop 1:0 @1000.5 0.5 0.25\n");
  EXPECT_EQ(recording->offset(), recording->size());

  ASSERT_TRUE(recording->rewind());
  EXPECT_EQ(items_text(*recording), once);
}

/// The first sample of a segment may be a rounding error before the segment's event.
TEST(Recording, SampleJustBeforeItsSegment_BelongsToIt) {
  const Folder folder;
  auto writer = XdfWriter::create(folder / "a.xdf", to_facts(floor_session()));
  ASSERT_TRUE(writer);
  const auto raw = (*writer)->add_stream(regular_stream("floor/raw", {"a_v"}, rate_of(100)));
  const auto events = (*writer)->add_stream(events_stream());
  const std::vector<std::pair<double, std::string>> texts = {{10.0, R"({"event":"segment","segment":3,"scan":0})"},
                                                             {20.0, R"({"event":"segment","segment":4,"scan":0})"}};
  const std::vector<double> one = {1.0};
  ASSERT_TRUE((*writer)->write_texts(events, texts, {}));
  for (const double time_s : {9.9, 19.994, 19.996}) ASSERT_TRUE((*writer)->write_samples(raw, time_s, one, {}));
  ASSERT_TRUE((*writer)->close());

  // Nothing lies before the first segment.
  EXPECT_EQ(items_text(*open(folder / "a.xdf"), "raw"),
            "raw 3:0 @9.9 1\n"
            "raw 3:999 @19.994 1\n"
            "raw 4:0 @19.996 1\n");
}

TEST(Recording, NotClosedOrIncomplete_SaysSo) {
  const Folder folder;
  small_recording(folder / "a.xdf")->abandon();
  ASSERT_TRUE(small_recording(folder / "b.xdf")->close_incomplete("disk full"));

  EXPECT_EQ(open(folder / "a.xdf.part")->damage(), "no footer: it was never closed");
  EXPECT_EQ(open(folder / "b.xdf")->damage(), "incomplete: disk full");
}

TEST(Recording, TornEnd_IsReadUpToThere) {
  const Folder folder;
  auto writer = small_recording(folder / "a.xdf");
  writer->abandon();
  const std::string bytes = bytes_of(folder / "a.xdf.part");
  put_file(folder / "b.xdf", bytes.substr(0, bytes.size() - 1));

  const auto recording = open(folder / "b.xdf");
  EXPECT_EQ(items_text(*recording), kSmallItems);
  EXPECT_EQ(recording->damage(), "chunk torn at byte 3249");
}

TEST(Recording, FactsOfANewerFormat_AreToldNotBelieved) {
  const Folder folder;
  auto writer = XdfWriter::create(folder / "a.xdf", {{"format_version", "2"}});
  ASSERT_TRUE(writer && (*writer)->close());

  const auto recording = open(folder / "a.xdf");

  EXPECT_FALSE(recording->session());
  EXPECT_EQ(recording->damage(), "the fact format_version is '2', only 1 is supported");
}

std::string foreign_samples(std::uint32_t stream, const std::vector<double>& times_s) {
  std::string content = number_bytes(stream);
  put_length(content, times_s.size());
  for (const double time_s : times_s) {
    content += '\x08';
    put(content, time_s);
    put(content, static_cast<float>(time_s));
  }
  return raw_chunk(3, content);
}
std::string foreign_marker(std::uint32_t stream, double time_s, const std::string& text) {
  std::string content = number_bytes(stream) + std::string("\x01\x01\x08", 3);
  put(content, time_s);
  put_length(content, text.size());
  return raw_chunk(3, content + text);
}

TEST(Recording, ForeignFile_StampsOffTheGridStartSegments) {
  const Folder folder;
  put_file(folder / "a.xdf", file_start() + header_chunk(1, "float32", "10", "1") + header_chunk(2, "string", "0", "1", "markers") +
                                 foreign_samples(1, {5.0, 5.1, 5.24, 5.3, 7.0, 7.1}) + foreign_samples(1, {7.2, 7.3, 6.0}) +
                                 foreign_marker(2, 7.19, "press\x01") + foreign_marker(2, 5.1, R"({"event":"trigger","scan":9})"));

  const auto recording = open(folder / "a.xdf");
  EXPECT_FALSE(recording->session());
  // Jitter below half a scan is no hole; the next chunk goes on; time going backwards is a hole.
  EXPECT_EQ(items_text(*recording),
            "EEG 0:0 @5 5 5.099999904633 5.239999771118 5.300000190735\n"
            "EEG 1:0 @7 7 7.099999904633\n"
            "EEG 1:2 @7.2 7.199999809265 7.300000190735\n"
            "EEG 2:0 @6 6\n"
            "event @7.19 {\"segment\":1,\"scan\":\"2\",\"marker\":{\"text\":\"press\xEF\xBF\xBD\"}}\n"
            "event @5.1 {\"scan\":\"9\",\"trigger\":{}}\n");
}

/// As LabRecorder writes: pretty-printed XML, headers first, a boundary, clock offsets per stream, chunks whose first sample alone has a
/// stamp, footers with few digits.
std::string lab_recorder_file() {
  const auto header = [](std::uint32_t stream, const std::string& name, const std::string& rate, const std::string& format) {
    return raw_chunk(
        2, number_bytes(stream) + "<?xml version=\"1.0\"?>\n<info>\n\t<name>" + name + "</name>\n\t<type>EEG</type>\n\t<channel_count>1" +
               "</channel_count>\n\t<nominal_srate>" + rate + "</nominal_srate>\n\t<channel_format>" + format +
               "</channel_format>\n\t<source_id>x</source_id>\n\t<desc>\n\t\t<channels>\n\t\t\t<channel>\n\t\t\t\t<label>C3</label>\n" +
               "\t\t\t\t<unit>microvolts</unit>\n\t\t\t</channel>\n\t\t</channels>\n\t</desc>\n</info>\n");
  };
  std::string bytes = std::string(kMagic) + raw_chunk(1, "<?xml version=\"1.0\"?>\n  <info>\n    <version>1.0</version>\n  </info>", 4);
  bytes += header(1, "ActiChamp-0", "100.0000000000000", "float32") + header(2, "Keyboard", "0.000000000000000", "string");
  bytes += raw_chunk(5, std::string(kBoundaryMark));
  for (const double first_s : {100.0, 100.03}) {
    std::string content = number_bytes(1) + std::string("\x04\x03\x00\x00\x00", 5);
    for (int sample = 0; sample < 3; ++sample) {
      content += sample == 0 ? '\x08' : '\x00';
      if (sample == 0) put(content, first_s);
      put(content, static_cast<float>(sample));
    }
    bytes += raw_chunk(3, content);
    std::string offset = number_bytes(1);
    put(offset, first_s);
    put(offset, 0.25);
    bytes += raw_chunk(4, offset);
  }
  bytes += foreign_marker(2, 100.02, "SPACE pressed");
  for (const auto& [stream, count] : {std::pair{1U, "6"}, std::pair{2U, "1"}})
    bytes += raw_chunk(6, number_bytes(stream) + "<?xml version=\"1.0\"?><info><first_timestamp>" + (stream == 1 ? "100" : "100.02") +
                              "</first_timestamp><last_timestamp>" + (stream == 1 ? "100.05" : "100.02") +
                              "</last_timestamp><sample_count>" + count + "</sample_count><clock_offsets></clock_offsets></info>");
  return bytes;
}

TEST(Recording, FileOfLabRecorder_IsReadAndVerified) {
  const Folder folder;
  put_file(folder / "a.xdf", lab_recorder_file());

  const auto recording = open(folder / "a.xdf");
  EXPECT_EQ(recording->damage(), "");
  EXPECT_EQ(recording->streams().at(0).channels.at(0).label, "C3");
  EXPECT_EQ(recording->streams().at(0).channels.at(0).unit, "microvolts");
  EXPECT_EQ(items_text(*recording),
            "ActiChamp-0 0:0 @100 0 1 2\n"
            "offset @100 ActiChamp-0 0.25\n"
            "ActiChamp-0 0:3 @100.03 0 1 2\n"
            "offset @100.03 ActiChamp-0 0.25\n"
            "event @100.02 {\"scan\":\"2\",\"marker\":{\"text\":\"SPACE pressed\"}}\n");
  const auto checked = verify(folder / "a.xdf");
  ASSERT_TRUE(checked) << checked.error().what;
  EXPECT_TRUE(checked->is_closed);
  EXPECT_FALSE(checked->has_index);
}

TEST(Recording, ForeignClockALittleOff_IsNoHole) {
  const Folder folder;
  std::vector<double> times_s(2000);
  for (std::size_t sample = 0; sample < times_s.size(); ++sample) times_s[sample] = 5.0 + 0.1001 * static_cast<double>(sample);
  put_file(folder / "a.xdf", file_start() + header_chunk(1, "float32", "10", "1") + foreign_samples(1, times_s));

  const auto recording = open(folder / "a.xdf");
  EXPECT_EQ(std::get<RecordedScans>(*recording->next().value()).count, 2000U);
  EXPECT_FALSE(recording->next().value());
}

TEST(Recording, MarkersOnly_OpenWithoutARate) {
  const Folder folder;
  put_file(folder / "a.xdf",
           file_start() + header_chunk(2, "string", "0", "1", "events") + foreign_marker(2, 7.0, R"({"event":"segment","segment":1})"));

  EXPECT_EQ(items_text(*open(folder / "a.xdf")), "event @7 {\"segment\":1,\"segment_start\":{}}\n");
}

TEST(Recording, NotEvenAFileHeader_Fails) {
  const Folder folder;
  put_file(folder / "a.xdf", "XDF:");
  EXPECT_EQ(Recording::open(folder / "a.xdf").error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(Recording::open(folder / "none.xdf").error().code, core::ErrorCode::NotFound);
}

}  // namespace
}  // namespace dts::record::xdf_test
