// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/clock.h"
#include "device/registry.h"
#include "record/xdf/xdf_reader.h"
#include "unit/device/replay/made_recording.h"
#include "unit/device/sim_rig.h"

namespace dts::device {
namespace {

using test::MadeRecording;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kFar = std::int64_t{1} << 62U;

class ReplayDevice : public test::WithFolder {
 protected:
  core::Result<std::unique_ptr<Device>> create(const std::string& uri) { return create_device(uri, {clock_, rig_}); }

  /// Of a recording that is made now, open and streaming.
  std::unique_ptr<Device> play(const MadeRecording& made, const std::string& options = "?speed=max", std::size_t block_scans = 64) {
    auto device = create("replay:" + test::make_recording(made, path("made.xdf")) + options);
    EXPECT_TRUE(device) << (device ? "" : core::to_string(device.error()));
    EXPECT_TRUE((*device)->open());
    EXPECT_TRUE((*device)->start({.rate = core::Rate::from_hz(made.rate_hz).value(), .max_block_scans = block_scans}));
    return std::move(*device);
  }

  core::VirtualClock clock_{kSecond};
  physics::RigModel rig_ = test::floor_rig();
};

/// Reads until something else than scans comes; all values and bits must be as made. The n-th scan of the stream comes first.
ReadResult expect_scans(Device& device, std::uint64_t n, std::uint64_t scans, std::size_t capacity = 64) {
  core::Block block(device.describe().channels.size(), capacity);
  std::uint64_t next = 0;
  while (true) {
    const ReadResult read = device.read(block, kFar);
    if (read.outcome != ReadOutcome::Scans) {
      EXPECT_EQ(next, scans);
      return read;
    }
    EXPECT_EQ(block.first_scan.value, next);
    for (std::size_t c = 0; c < block.channel_count(); ++c) {
      for (std::size_t i = 0; i < block.count(); ++i) {
        const double expected = test::made_value(c, n + next + i);
        const bool is_same = std::isnan(expected) ? std::isnan(block.column(c)[i]) : expected == block.column(c)[i];
        EXPECT_TRUE(is_same) << "channel " << c << ", scan " << next + i;
        EXPECT_EQ(block.quality(c)[i], test::made_bits(c, n + next + i)) << "channel " << c << ", scan " << next + i;
        if (testing::Test::HasFailure()) return read;
      }
    }
    next += block.count();
  }
}

/// Where the header of a stream ends, before any of its samples.
std::uint64_t end_of_header(const std::string& file, const std::string& stream) {
  const auto reader = record::XdfReader::open(file).value();
  while (auto chunk = reader->next().value()) {
    const auto* header = std::get_if<record::StreamHeader>(&chunk->content);
    if (header != nullptr && header->info.name == stream) return chunk->offset + chunk->length;
  }
  ADD_FAILURE() << "no stream " << stream;
  return 0;
}

TEST_F(ReplayDevice, Description_PutsTheColumnsWhereTheDeviceHadThem) {
  const MadeRecording made{.sensors = 2, .aux = 2, .rate_hz = 1500.0, .stages = {"guard x=1"}, .state = {1.0, std::nan(""), -0.1}};
  const auto device = create("replay:" + test::make_recording(made, path("a.xdf")));

  ASSERT_TRUE(device) << core::to_string(device.error());
  const DeviceDescription& description = (*device)->describe();
  ASSERT_EQ(description.channels.size(), 4U);
  EXPECT_EQ(description.channels[0].name, "extra1");
  EXPECT_EQ(description.channels[0].role, ChannelRole::Auxiliary);
  EXPECT_EQ(description.channels[2].name, "w1");
  EXPECT_EQ(description.channels[2].role, ChannelRole::Sensor);
  EXPECT_EQ(description.channels[3].resolution, 10.0 / 2048.0);
  EXPECT_EQ(description.serial, "made-7");
  EXPECT_EQ(description.model, "Made device");
  EXPECT_TRUE(description.waits_for_reader);
  EXPECT_THAT(description.recorded_pipeline.stages, ElementsAre("guard x=1"));
  EXPECT_THAT(description.recorded_pipeline.state, ElementsAre(1.0, testing::NanSensitiveDoubleEq(std::nan("")), -0.1));
  EXPECT_EQ((*device)->exact_rate(test::rate_of(1500.5)).value(), test::rate_of(1500.0)) << "its DAQ may have been a little off";
  const auto other = (*device)->exact_rate(test::rate_of(100.0));
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().hint, HasSubstr("recorded: 1500"));
}

TEST_F(ReplayDevice, Max_GivesEveryValueAndBitAndThenIsGone) {
  for (const std::size_t capacity : {1U, 7U, 64U, 1000U}) {
    std::filesystem::remove(path("made.xdf"));
    std::filesystem::remove(path("made.xdf.idx"));
    const auto device = play({.segments = {{.scans = 1234}}, .first_scan = 77}, "?speed=max", 1000);

    const ReadResult end = expect_scans(*device, 77, 1234, capacity);

    EXPECT_EQ(end.outcome, ReadOutcome::Gone);
    EXPECT_EQ(device->state(), DeviceState::Gone);
    EXPECT_EQ(clock_.now_ns(), kSecond) << "it waited";
    ASSERT_TRUE(device->close());
    const auto again = device->open();
    ASSERT_FALSE(again);
    EXPECT_EQ(again.error().code, core::ErrorCode::NotFound);
    EXPECT_THAT(again.error().what, HasSubstr("played to its end"));
  }
}

TEST_F(ReplayDevice, Gaps_ComeWithTheirReasonAndCount) {
  const core::Gap overrun{.reason = core::GapReason::Overrun, .missing_scans = 42, .is_exact = true};
  const core::Gap unplugged{.reason = core::GapReason::Unplugged, .missing_scans = 500, .is_exact = false};
  const auto device = play({.segments = {{.scans = 300}, {.scans = 55, .gap = overrun}, {.scans = 200, .gap = unplugged}}});

  const ReadResult first = expect_scans(*device, 0, 300);
  const ReadResult second = expect_scans(*device, 342, 55);
  const ReadResult third = expect_scans(*device, 342 + 55 + 500, 200);

  EXPECT_EQ(first.outcome, ReadOutcome::Gap);
  EXPECT_EQ(first.gap.reason, core::GapReason::Overrun);
  EXPECT_EQ(first.gap.missing_scans, 42U);
  EXPECT_TRUE(first.gap.is_exact);
  EXPECT_EQ(second.outcome, ReadOutcome::Gap);
  EXPECT_EQ(second.gap.reason, core::GapReason::Unplugged);
  EXPECT_EQ(second.gap.missing_scans, 500U);
  EXPECT_FALSE(second.gap.is_exact);
  EXPECT_EQ(third.outcome, ReadOutcome::Gone);
}

TEST_F(ReplayDevice, ScansThatNeverReachedTheFile_AreAGapOfTheRing) {
  const auto device = play({.segments = {{.scans = 400}}, .lost_at = 150});

  const ReadResult lost = expect_scans(*device, 0, 150);
  const ReadResult end = expect_scans(*device, 160, 240);

  EXPECT_EQ(lost.outcome, ReadOutcome::Gap);
  EXPECT_EQ(lost.gap.reason, core::GapReason::RingFull);
  EXPECT_EQ(lost.gap.missing_scans, 10U);
  EXPECT_EQ(end.outcome, ReadOutcome::Gone);
}

TEST_F(ReplayDevice, Loop_StartsAgainAfterAGapWithoutLoss) {
  const auto device = play({.segments = {{.scans = 300}}}, "?speed=max&loop=1");

  for (int round = 0; round < 3; ++round) {
    const ReadResult again = expect_scans(*device, 0, 300);
    EXPECT_EQ(again.outcome, ReadOutcome::Gap);
    EXPECT_NE(again.gap.reason, core::GapReason::None);
    EXPECT_EQ(again.gap.missing_scans, 0U);
  }
}

TEST_F(ReplayDevice, BeginningInTheMiddleOfASegment_IsDescribedWithItsIndex) {
  const auto device = create("replay:" + test::make_recording({.segments = {{.scans = 300}}, .first_scan = 1234}, path("a.xdf")));

  ASSERT_TRUE(device) << core::to_string(device.error());
  EXPECT_EQ((*device)->describe().recorded_pipeline.first_scan, 1234U);
  EXPECT_EQ((*device)->report().checks.front().outcome, DeviceCheck::Outcome::Passed);
}

TEST_F(ReplayDevice, LoopOfARecordingWithoutScans_EndsInsteadOfSpinning) {
  const auto file = test::make_recording({.sensors = 1, .aux = 0, .segments = {{.scans = 10}}, .is_closed = false}, path("empty.xdf"));
  std::filesystem::resize_file(file, end_of_header(file, "floor/raw"));
  const auto device = create("replay:" + file + "?speed=max&loop=1");
  ASSERT_TRUE(device) << core::to_string(device.error());
  ASSERT_TRUE((*device)->open());
  ASSERT_TRUE((*device)->start({.rate = test::rate_of(100.0), .max_block_scans = 64}));

  core::Block block(1, 64);
  EXPECT_EQ((*device)->read(block, kFar).outcome, ReadOutcome::Gone);
  ASSERT_TRUE((*device)->close());
  const auto again = (*device)->open();
  ASSERT_FALSE(again);
  EXPECT_THAT(again.error().what, HasSubstr("no scan"));
}

TEST_F(ReplayDevice, Speed_PacesByTheClockAndKeepsTheRecordedTimeAxis) {
  for (const auto& [speed, expected_s] : {std::pair{"1", 10.0}, {"100", 0.1}, {"0.1", 100.0}}) {
    SCOPED_TRACE(speed);
    std::filesystem::remove(path("made.xdf"));
    std::filesystem::remove(path("made.xdf.idx"));
    const auto device = play({.segments = {{.scans = 1001}}}, std::string("?speed=") + speed);
    const std::int64_t begun_ns = clock_.now_ns();
    core::Block block(3, 64);
    std::int64_t last_ns = 0;

    for (std::size_t scans = 0; scans < 1001; scans += block.count()) {
      ASSERT_EQ(device->read(block, kFar).outcome, ReadOutcome::Scans);
      last_ns = block.host_time_ns + static_cast<std::int64_t>(block.count() - 1) * kSecond / 100;
    }

    EXPECT_EQ(clock_.now_ns() - begun_ns, static_cast<std::int64_t>(expected_s * 1e9));
    EXPECT_EQ(last_ns - begun_ns, 10 * kSecond);
  }
}

TEST_F(ReplayDevice, NightBetweenSegments_IsNotWaitedForButStaysOnTheTimeAxis) {
  const core::Gap night{.reason = core::GapReason::Unplugged, .missing_scans = 100 * 3600 * 10, .is_exact = false};
  const auto device = play({.segments = {{.scans = 100}, {.scans = 100, .gap = night}}}, "?speed=1");
  const std::int64_t begun_ns = clock_.now_ns();

  EXPECT_EQ(expect_scans(*device, 0, 100).outcome, ReadOutcome::Gap);
  core::Block block(3, 64);
  ASSERT_EQ(device->read(block, kFar).outcome, ReadOutcome::Scans);

  EXPECT_LT(clock_.now_ns() - begun_ns, 10 * kSecond);
  EXPECT_EQ(block.host_time_ns - begun_ns, kSecond + 36'000 * kSecond);
}

TEST_F(ReplayDevice, RecordingOfACrash_PlaysUpToItsEnd) {
  const auto file = test::make_recording({.segments = {{.scans = 500}}, .is_closed = false}, path("crash.xdf"));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 7);  // torn in the middle of a chunk
  auto device = create("replay:" + file + "?speed=max");
  ASSERT_TRUE(device) << core::to_string(device.error());
  ASSERT_TRUE((*device)->open());
  ASSERT_TRUE((*device)->start({.rate = test::rate_of(100.0), .max_block_scans = 64}));

  core::Block block(3, 64);
  std::size_t scans = 0;
  while ((*device)->read(block, kFar).outcome == ReadOutcome::Scans) scans += block.count();

  EXPECT_GT(scans, 400U);
  EXPECT_EQ((*device)->state(), DeviceState::Gone);
  EXPECT_EQ((*device)->report().checks.front().outcome, DeviceCheck::Outcome::Warning);
}

TEST_F(ReplayDevice, FileThatLacksTheDevicesChannels_IsRefusedWithItsReason) {
  const auto foreign = create("replay:" + test::make_recording({.has_device_channels = false}, path("foreign.xdf")));

  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().code, core::ErrorCode::InvalidArgument);
  EXPECT_THAT(foreign.error().what, HasSubstr("channel w1 of stream floor/raw has no device channel"));
}

TEST_F(ReplayDevice, WhatIsNoRecordingOrNoOption_IsRefused) {
  std::ofstream(path("text.xdf")) << "t_s,x_mm\n1,2\n";
  const std::string good = test::make_recording({}, path("good.xdf"));

  EXPECT_EQ(create("replay:" + path("none.xdf")).error().code, core::ErrorCode::NotFound);
  EXPECT_EQ(create("replay:" + path("text.xdf")).error().code, core::ErrorCode::DataDamaged);
  EXPECT_EQ(create("replay:").error().code, core::ErrorCode::InvalidArgument);
  for (const char* options : {"?speed=0", "?speed=101", "?speed=fast", "?speed=nan", "?loop=2", "?sped=1"}) {
    const auto refused = create("replay:" + good + options);
    ASSERT_FALSE(refused) << options;
    EXPECT_EQ(refused.error().code, core::ErrorCode::InvalidArgument) << options;
  }
}

TEST_F(ReplayDevice, TwoRigsWithTheSameFile_DoNotCompete) { EXPECT_FALSE(compete("replay:a.xdf", "replay:a.xdf")); }

}  // namespace
}  // namespace dts::device
