// SPDX-License-Identifier: Apache-2.0
// Frames in, a recording out: read back as scans and events.
#include "record/recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "record/xdf/xdf_reader.h"
#include "support/event_text.h"
#include "unit/record/recording_text.h"

namespace dts::record {
namespace {

constexpr std::int64_t kStartNs = 8'000'000'000'123;  // monotonic, of the first scan
constexpr std::size_t kRaw = 0;
constexpr std::size_t kCop = 1;
constexpr std::size_t kAux = 2;

/// A rig of two sensors at 1000 Hz, a computed stream at half the rate, one further channel.
class RecorderTest : public testing::Test {
 protected:
  RecorderTest() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-recorder-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    file_ = folder_ / "x.xdf";
    for (const std::size_t channels : {2, 1, 1}) frame_.streams.emplace_back(channels, 50);
  }
  ~RecorderTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] static std::vector<RecordedStream> streams() {
    const core::Rate full = core::Rate::create(1000, 1).value();
    const core::Rate half = core::Rate::create(500, 1).value();
    const auto info = [](const std::string& name, ValueType type, core::Rate rate, std::vector<ChannelInfo> channels) {
      return StreamInfo{.name = "floor/" + name, .content = "DTS", .value_type = type, .rate = rate, .channels = std::move(channels)};
    };
    return {{.frame_index = kRaw,
             .info = info("raw", ValueType::Double64, full, {{.label = "w1_v", .unit = "V"}, {.label = "w2_v", .unit = "V"}})},
            {.frame_index = kCop, .info = info("cop", ValueType::Float32, half, {{.label = "ml_mm", .unit = "mm"}})},
            {.frame_index = kAux, .info = info("aux", ValueType::Double64, full, {{.label = "ch3", .unit = "V"}})}};
  }
  [[nodiscard]] std::unique_ptr<Recorder> recorder() const {
    return Recorder::create(file_, {.session_id = "s", .rig = "floor"}, streams()).value();
  }

  /// The frame of `scans` scans from `first` of a segment, with values that say where they belong.
  core::Frame& frame(std::uint32_t segment, std::uint64_t first, std::size_t scans, std::int64_t host_ns) {
    frame_.segment = segment;
    frame_.gap_before = {};
    for (std::size_t stream = 0; stream < frame_.streams.size(); ++stream) {
      core::Block& block = frame_.streams[stream];
      const std::size_t every = stream == kCop ? 2 : 1;
      block.segment = segment;
      block.first_scan = {first / every};
      block.host_time_ns = host_ns;
      block.set_count(scans / every);
      for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
        for (std::size_t i = 0; i < block.count(); ++i) {
          block.column(channel)[i] = value(stream, channel, segment, first / every + i);
          block.quality(channel)[i] = 0;
        }
      }
    }
    return frame_;
  }
  [[nodiscard]] static std::int64_t host_ns(std::uint64_t scan) { return kStartNs + static_cast<std::int64_t>(scan) * 1'000'000; }
  [[nodiscard]] static double value(std::size_t stream, std::size_t channel, std::uint32_t segment, std::uint64_t scan) {
    return static_cast<double>(stream * 1000 + channel * 100 + segment * 10) + static_cast<double>(scan) / 1024.0;
  }

  /// Everything in the closed file, by kind.
  struct Contents {
    std::vector<RecordedScans> scans;
    std::vector<RecordedChange> changes;
    std::vector<TimedEvent> events;
    std::vector<RecordedOffset> offsets;
  };
  [[nodiscard]] static Contents read(const std::string& file) {
    Contents contents;
    auto recording = Recording::open(file).value();
    EXPECT_EQ(recording->damage(), "");
    while (auto item = recording->next().value()) {
      if (auto* scans = std::get_if<RecordedScans>(&*item)) contents.scans.push_back(std::move(*scans));
      if (auto* change = std::get_if<RecordedChange>(&*item)) contents.changes.push_back(std::move(*change));
      if (auto* event = std::get_if<TimedEvent>(&*item)) contents.events.push_back(std::move(*event));
      if (auto* offset = std::get_if<RecordedOffset>(&*item)) contents.offsets.push_back(*offset);
    }
    return contents;
  }
  [[nodiscard]] std::string close(Recorder& recorder) const {
    EXPECT_TRUE(recorder.flush());
    return recorder.close("").value().file;
  }
  [[nodiscard]] static std::vector<RecordedScans> scans_of(Recording& recording) {
    std::vector<RecordedScans> found;
    while (auto item = recording.next().value()) {
      if (auto* scans = std::get_if<RecordedScans>(&*item)) found.push_back(std::move(*scans));
    }
    return found;
  }
  /// Of the recording once it is closed: all items, or those of one kind.
  [[nodiscard]] std::string text(Recorder& recorder, const std::string& only = "") const {
    const auto recording = Recording::open(close(recorder)).value();
    EXPECT_EQ(recording->damage(), "");
    return items_text(*recording, only);
  }

  std::filesystem::path folder_;
  std::string file_;
  core::Frame frame_;
};

TEST_F(RecorderTest, Frames_EveryScanComesBackAtItsPlaceWithItsValue) {
  auto recorder = this->recorder();
  for (std::uint64_t first = 100; first < 1100; first += 20) ASSERT_TRUE(recorder->take(frame(0, first, 20, host_ns(first)), {}));

  const auto recording = Recording::open(close(*recorder)).value();

  std::array<std::uint64_t, 3> next{100, 50, 100};
  for (const RecordedScans& scans : scans_of(*recording)) {
    const std::size_t stream = scans.values.size() / scans.count == 2 ? kRaw : (scans.values[0] >= 2000.0 ? kAux : kCop);
    ASSERT_EQ(scans.first_scan.value, next[stream]);
    const double rate_hz = stream == kCop ? 500.0 : 1000.0;
    EXPECT_NEAR(scans.first_time_s, 8000.000000123 + static_cast<double>(next[stream] - (stream == kCop ? 50 : 100)) / rate_hz + 0.1, 0.11);
    EXPECT_LE(static_cast<double>(scans.count) / rate_hz, kLongestUnwrittenS);
    for (std::size_t i = 0; i < scans.values.size(); ++i) {
      const std::size_t channels = stream == kRaw ? 2 : 1;
      ASSERT_EQ(scans.values[i], static_cast<double>(static_cast<float>(value(stream, i % channels, 0, next[stream] + i / channels))));
    }
    next[stream] += scans.count;
  }
  EXPECT_EQ(next, (std::array<std::uint64_t, 3>{1100, 550, 1100}));
}

TEST_F(RecorderTest, DriftingClock_TimeAxisHasNoJitterAndOffsetsTellTheDrift) {
  auto recorder = this->recorder();
  for (std::uint64_t first = 0; first < 12'000; first += 20) {
    const auto drift_ns = static_cast<std::int64_t>(first) * 50;  // 50 ppm, with jitter of the host's estimate
    ASSERT_TRUE(recorder->take(frame(0, first, 20, host_ns(first) + drift_ns + static_cast<std::int64_t>(first % 7) * 1000), {}));
  }

  const std::string file = close(*recorder);
  const auto recording = Recording::open(file).value();
  EXPECT_EQ(items_text(*recording, "offset"),
            "offset @8000.180000123 raw 1.4e-05\n"
            "offset @8000.180000123 cop 1.4e-05\n"
            "offset @8000.180000123 aux 1.4e-05\n"
            "offset @8000.180000123 events 1.4e-05\n"
            "offset @8000.180000123 quality 1.4e-05\n"
            "offset @8005.180000123 raw 0.000259\n"
            "offset @8005.180000123 cop 0.000259\n"
            "offset @8005.180000123 aux 0.000259\n"
            "offset @8005.180000123 events 0.000259\n"
            "offset @8005.180000123 quality 0.000259\n"
            "offset @8010.180000123 raw 0.000511\n"
            "offset @8010.180000123 cop 0.000511\n"
            "offset @8010.180000123 aux 0.000511\n"
            "offset @8010.180000123 events 0.000511\n"
            "offset @8010.180000123 quality 0.000511\n")
      << "at the start and every 5 s: of three streams, the events and the quality";
  ASSERT_TRUE(recording->rewind());
  const auto all = scans_of(*recording);
  for (const RecordedScans& scans : all) {
    const double rate_hz = scans.values.size() == scans.count && scans.values[0] < 2000.0 ? 500.0 : 1000.0;
    EXPECT_NEAR(scans.first_time_s, all.front().first_time_s + static_cast<double>(scans.first_scan.value) / rate_hz, 2e-9);
  }
}

TEST_F(RecorderTest, Gap_StartsASegmentWhoseEventSaysWhy) {
  auto recorder = this->recorder();
  ASSERT_TRUE(recorder->take(frame(0, 0, 4, host_ns(0)), {}));
  core::Frame& after = frame(1, 0, 4, host_ns(540));
  after.gap_before = {.reason = core::GapReason::Overrun, .missing_scans = 500, .is_exact = true};
  after.streams[kCop].column(0)[1] = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(recorder->take(after, {}));

  EXPECT_EQ(text(*recorder),
            "event @8000.000000123 {\"host_time_ns\":\"8000000000123\",\"segment_start\":{}}\n"
            "raw 0:0 @8000.000000123 0 100 0.0009765625 100.0009765625 0.001953125 100.001953125 0.0029296875 100.0029296875\n"
            "quality 0:0 @8000.000000123 0 0 0\n"
            "cop 0:0 @8000.000000123 1000 1000.000976562\n"
            "aux 0:0 @8000.000000123 2000 2000.000976562 2000.001953125 2000.002929688\n"
            "event @8000.540000123 "
            "{\"segment\":1,\"host_time_ns\":\"8000540000123\",\"segment_start\":{\"reason\":\"GAP_REASON_OVERRUN\","
            "\"missing_scans\":\"500\",\"is_exact\":true}}\n"
            "offset @8000.540000123 raw 0\n"
            "offset @8000.540000123 cop 0\n"
            "offset @8000.540000123 aux 0\n"
            "offset @8000.540000123 events 0\n"
            "offset @8000.540000123 quality 0\n"
            "raw 1:0 @8000.540000123 10 110 10.0009765625 110.0009765625 10.001953125 110.001953125 10.0029296875 110.0029296875\n"
            "quality 1:0 @8000.540000123 0 0 0\n"
            "cop 1:0 @8000.540000123 1010 nan\n"
            "aux 1:0 @8000.540000123 2010 2010.000976562 2010.001953125 2010.002929688\n");
}

TEST_F(RecorderTest, Gap_IsALossThatWriterAndReadersTellAlike) {
  auto recorder = this->recorder();
  core::Frame& first = frame(2, 0, 40, host_ns(0));
  first.gap_before = {.reason = core::GapReason::Unplugged, .missing_scans = 9, .is_exact = true};  // before the recording
  ASSERT_TRUE(recorder->take(first, {}));
  core::Frame& after = frame(3, 0, 40, host_ns(540));
  after.gap_before = {.reason = core::GapReason::Overrun, .missing_scans = 500, .is_exact = true};
  ASSERT_TRUE(recorder->take(after, {}));
  after.gap_before = {};
  ASSERT_TRUE(recorder->take(frame(3, 50, 10, host_ns(590)), {}));  // the recorder was too slow for ten scans
  recorder->note_loss(5);                                           // and for five at the end
  ASSERT_TRUE(recorder->flush());

  core::Losses expected;
  expected.add(core::GapReason::Overrun, {.gaps = 1, .scans = 500});
  expected.add(core::GapReason::RingFull, {.gaps = 2, .scans = 15});
  EXPECT_EQ(recorder->losses(), expected);
  EXPECT_NEAR(recorder->duration_s(), 0.6, 1e-9) << "gaps included";

  const std::string file = recorder->close("").value().file;
  const auto recording = Recording::open(file).value();
  EXPECT_EQ(recording->losses(), expected);
  EXPECT_NEAR(recording->duration_s(), 0.6, 1e-9);
  EXPECT_NEAR(verify(file).value().duration_s, 0.6, 1e-9);
}

using test::event_of;

TEST_F(RecorderTest, Events_StandOnTheTimeOfTheirScanInTheirOrder) {
  auto recorder = this->recorder();
  ASSERT_TRUE(recorder->take(event_of("scan: 15 marker { text: 'before anything was recorded' }")));
  ASSERT_TRUE(recorder->take(frame(0, 0, 40, host_ns(0)), {}));
  const std::vector<core::Event> events{
      core::TriggerEvent{.segment = 0, .scan = {47}, .is_rising = true},
      core::ReachEvent{.step = core::ReachStep::P3, .number = 2, .scan = {50}},
      core::ReachEvent{.step = core::ReachStep::Final, .number = 2, .scan = {58}},
      core::ClassEvent{.number = 2, .scan = {58}, .movement = {.trunk_class = core::TrunkClass::Moderate}}};
  ASSERT_TRUE(recorder->take(frame(0, 40, 20, host_ns(40)), events));

  EXPECT_EQ(text(*recorder, "event"),
            R"(event @8000.000000123 {"host_time_ns":"8000000000123","segment_start":{}}
event @8000.015000123 {"scan":"15","marker":{"text":"before anything was recorded"}}
event @8000.047000123 {"scan":"47","trigger":{"edge":"TRIGGER_EDGE_RISING"}}
event @8000.050000123 {"scan":"50","reach":{"step":"REACH_STEP_P3","number":2}}
event @8000.058000123 {"scan":"58","reach":{"step":"REACH_STEP_FINAL","number":2}}
event @8000.058000123 {"scan":"58","movement":{"number":2,"trunk_class":2,"probability":[0,0,0]}}
)");
}

TEST_F(RecorderTest, EventsOfOtherSegments_StandAtTheFirstOrTheLastScan) {
  auto recorder = this->recorder();
  ASSERT_TRUE(recorder->take(event_of("segment: 3 scan: 900 session { message: 'before the recording' }")));
  ASSERT_TRUE(recorder->take(frame(4, 20, 40, host_ns(20)), {}));
  ASSERT_TRUE(recorder->take(event_of("segment: 5 device { message: 'never came' }")));

  EXPECT_EQ(text(*recorder, "event"),
            R"(event @8000.020000123 {"segment":4,"scan":"20","host_time_ns":"8000020000123","segment_start":{}}
event @8000.020000123 {"segment":4,"scan":"20","session":{"message":"before the recording"}}
event @8000.060000123 {"segment":5,"device":{"message":"never came"}}
)");
}

TEST_F(RecorderTest, NoScanAtAll_TheFileSaysSoWithItsEvents) {
  auto recorder = Recorder::create(file_, {.session_id = "s", .rig = "floor", .started_utc_ns = 9'000'000'000}, streams()).value();
  ASSERT_TRUE(recorder->take(event_of("session { state: SESSION_STATE_STARTING }")));
  ASSERT_TRUE(recorder->flush());
  ASSERT_TRUE(recorder->close("the device delivered no scan"));

  EXPECT_EQ(verify(file_).value().incomplete, "the device delivered no scan");
  auto recording = Recording::open(file_).value();
  const auto item = recording->next().value();
  ASSERT_TRUE(item && std::holds_alternative<TimedEvent>(*item));
  EXPECT_EQ(std::get<TimedEvent>(*item).time_s, 9.0);
}

TEST_F(RecorderTest, Quality_StandsInTheFileWhereverItChanges) {
  auto recorder = this->recorder();
  core::Frame& bad = frame(0, 0, 40, host_ns(0));
  for (std::size_t i = 10; i < 13; ++i) bad.streams[kRaw].quality(1)[i] = core::quality::kRail;
  bad.streams[kAux].quality(0)[39] = core::quality::kNoContact;
  ASSERT_TRUE(recorder->take(bad, {}));

  EXPECT_EQ(text(*recorder, "quality"),
            "quality 0:0 @8000.000000123 0 0 0\n"
            "quality 0:10 @8000.010000123 0 1 0\n"
            "quality 0:13 @8000.013000123 0 0 0\n"
            "quality 0:39 @8000.039000123 0 0 16\n");
}

TEST_F(RecorderTest, FramesThatNeverCame_AreALossThatTheFileTells) {
  RecordProperty("requirement", "REC-7");
  auto recorder = this->recorder();
  ASSERT_TRUE(recorder->take(frame(0, 0, 40, host_ns(0)), {}));
  ASSERT_TRUE(recorder->take(frame(0, 41, 40, host_ns(41)), {}));
  ASSERT_TRUE(recorder->flush());

  EXPECT_EQ(recorder->lost_scans(), 1U);
  const std::string file = recorder->close("").value().file;

  EXPECT_EQ(verify(file).value().incomplete, "1 scans were dropped: the queue to the recorder was full");
}

TEST_F(RecorderTest, StageState_StandsInTheRawStreamsHeader) {
  auto recorder = this->recorder();
  recorder->set_stage_state(std::array{0.1, -3.0, std::numeric_limits<double>::quiet_NaN()});
  ASSERT_TRUE(recorder->take(frame(0, 0, 40, host_ns(0)), {}));

  const auto recording = Recording::open(close(*recorder)).value();

  EXPECT_EQ(fact(recording->streams()[recording->find_stream("raw").value()].facts, "stage_state"), "0.1 -3 nan");
}

}  // namespace
}  // namespace dts::record
