// SPDX-License-Identifier: Apache-2.0
#include "record/recording.h"

#include <gtest/gtest.h>

#include "record/xdf/recovery.h"
#include "unit/record/xdf_fixture.h"

namespace dts::record::xdf_test {
namespace {

/// All items by kind, in file order.
struct Items {
  std::vector<RecordedScans> scans;
  std::vector<RecordedChange> changes;
  std::vector<TimedEvent> events;
  std::vector<RecordedOffset> offsets;
  std::string kinds;  ///< "s", "c", "e", "o" in file order
};
Items items_of(Recording& recording) {
  Items items;
  while (true) {
    auto item = recording.next();
    EXPECT_TRUE(item) << item.error().what;
    if (!item || !*item) return items;
    items.kinds += "sceo"[(*item)->index()];
    if (auto* scans = std::get_if<RecordedScans>(&**item)) items.scans.push_back(std::move(*scans));
    if (auto* change = std::get_if<RecordedChange>(&**item)) items.changes.push_back(std::move(*change));
    if (auto* event = std::get_if<TimedEvent>(&**item)) items.events.push_back(std::move(*event));
    if (auto* offset = std::get_if<RecordedOffset>(&**item)) items.offsets.push_back(*offset);
  }
}

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
  EXPECT_EQ(recording->sample_count(99), 0U);
}

TEST(Recording, Scans_HaveTheirSegmentsAndTheirOwnIndices) {
  const Folder folder;
  const auto recording = small(folder);
  const auto raw = *recording->find_stream("raw");
  const auto cop = *recording->find_stream("cop");

  const Items items = items_of(*recording);

  EXPECT_EQ(items.kinds, "esscsoess");
  ASSERT_EQ(items.scans.size(), 5U);
  const auto expect = [&items](std::size_t index, std::size_t stream, std::uint32_t segment, std::uint64_t first_scan, double time_s) {
    const auto& scans = items.scans[index];
    EXPECT_EQ(scans.stream, stream) << index;
    EXPECT_EQ(scans.segment, segment) << index;
    EXPECT_EQ(scans.first_scan.value, first_scan) << index;
    EXPECT_DOUBLE_EQ(scans.first_time_s, time_s) << index;
  };
  // The recording starts at raw scan 40; cop, of half the rate, counts its own: 20.
  expect(0, raw, 0, 40, 1000.0);
  expect(1, cop, 0, 20, 1000.0);
  expect(2, raw, 0, 44, 1000.04);
  expect(3, raw, 1, 0, 1000.5);
  expect(4, cop, 1, 0, 1000.5);
  EXPECT_EQ(items.scans[0].count, 4U);
  EXPECT_EQ(items.scans[0].values, (std::vector<double>{1, -1, 2, -2, 3, -3, 4, -4}));
}

TEST(Recording, EventsChangesAndOffsets_ComeAsTheyWereWritten) {
  const Folder folder;
  const auto recording = small(folder);

  const Items items = items_of(*recording);

  ASSERT_EQ(items.events.size(), 2U);
  EXPECT_EQ(items.events[0].time_s, 1000.0);
  EXPECT_EQ(items.events[0].event, (RecordedEvent{.event = "segment", .segment = 0, .scan = {40}}));
  ASSERT_EQ(items.changes.size(), 1U);
  EXPECT_EQ(items.changes[0].scan.value, 42U);
  EXPECT_EQ(items.changes[0].values, std::vector<double>{3});
  ASSERT_EQ(items.offsets.size(), 1U);
  EXPECT_EQ(items.offsets[0].offset_s, -1.5e-6);
  EXPECT_EQ(items.offsets[0].stream, *recording->find_stream("raw"));
}

TEST(Recording, Rewind_GivesTheSameAgain) {
  const Folder folder;
  const auto recording = small(folder);
  const Items once = items_of(*recording);
  EXPECT_EQ(recording->offset(), recording->size());

  ASSERT_TRUE(recording->rewind());
  const Items again = items_of(*recording);

  EXPECT_EQ(again.kinds, once.kinds);
  EXPECT_EQ(again.scans.back().values, once.scans.back().values);
  EXPECT_EQ(again.scans.back().segment, once.scans.back().segment);
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

  const Items items = items_of(*open(folder / "a.xdf"));

  ASSERT_EQ(items.scans.size(), 3U);
  EXPECT_EQ(items.scans[0].segment, 3U) << "nothing lies before the first segment";
  EXPECT_EQ(items.scans[0].first_scan.value, 0U);
  EXPECT_EQ(items.scans[1].segment, 3U);
  EXPECT_EQ(items.scans[1].first_scan.value, 999U);
  EXPECT_EQ(items.scans[2].segment, 4U);
  EXPECT_EQ(items.scans[2].first_scan.value, 0U);
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
  const Items items = items_of(*recording);

  EXPECT_EQ(items.scans.size(), 4U);
  EXPECT_NE(recording->damage().find("chunk torn at byte"), std::string::npos) << recording->damage();
}

TEST(Recording, FactsOfANewerFormat_AreToldNotBelieved) {
  const Folder folder;
  auto writer = XdfWriter::create(folder / "a.xdf", {{"format_version", "2"}});
  ASSERT_TRUE(writer && (*writer)->close());

  const auto recording = open(folder / "a.xdf");

  EXPECT_FALSE(recording->session());
  EXPECT_NE(recording->damage().find("format_version"), std::string::npos);
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
  const Items items = items_of(*recording);

  EXPECT_FALSE(recording->session());
  ASSERT_EQ(items.scans.size(), 4U);
  EXPECT_EQ(items.scans[0].count, 4U) << "jitter below half a scan is no hole";
  EXPECT_EQ(items.scans[1].segment, 1U);
  EXPECT_EQ(items.scans[1].count, 2U);
  EXPECT_EQ(items.scans[2].segment, 1U) << "the next chunk goes on";
  EXPECT_EQ(items.scans[2].first_scan.value, 2U);
  EXPECT_EQ(items.scans[2].values.size(), 2U);
  EXPECT_EQ(items.scans[3].segment, 2U) << "time going backwards is a hole";
  EXPECT_EQ(items.scans[3].first_scan.value, 0U);
  ASSERT_EQ(items.events.size(), 2U);
  EXPECT_EQ(items.events[0].event,
            (RecordedEvent{.event = "marker", .segment = 1, .scan = {2}, .values = {{"text", std::string("press\uFFFD")}}}));
  EXPECT_EQ(items.events[1].event.event, "trigger");
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
  const Items items = items_of(*recording);

  EXPECT_EQ(recording->damage(), "");
  EXPECT_EQ(recording->streams().at(0).channels.at(0).label, "C3");
  EXPECT_EQ(recording->streams().at(0).channels.at(0).unit, "microvolts");
  EXPECT_EQ(items.kinds, "sosoe");
  EXPECT_EQ(items.scans.at(1).segment, 0U);
  EXPECT_EQ(items.scans.at(1).first_scan.value, 3U);
  EXPECT_EQ(items.events.at(0).event, (RecordedEvent{.event = "marker", .segment = 0, .scan = {2}, .values = {{"text", "SPACE pressed"}}}));
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

  const Items items = items_of(*open(folder / "a.xdf"));

  ASSERT_EQ(items.scans.size(), 1U);
  EXPECT_EQ(items.scans[0].count, 2000U);
}

TEST(Recording, MarkersOnly_OpenWithoutARate) {
  const Folder folder;
  put_file(folder / "a.xdf",
           file_start() + header_chunk(2, "string", "0", "1", "events") + foreign_marker(2, 7.0, R"({"event":"segment","segment":1})"));

  const Items items = items_of(*open(folder / "a.xdf"));

  EXPECT_EQ(items.kinds, "e");
}

TEST(Recording, NotEvenAFileHeader_Fails) {
  const Folder folder;
  put_file(folder / "a.xdf", "XDF:");
  EXPECT_EQ(Recording::open(folder / "a.xdf").error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(Recording::open(folder / "none.xdf").error().code, core::ErrorCode::NotFound);
}

}  // namespace
}  // namespace dts::record::xdf_test
