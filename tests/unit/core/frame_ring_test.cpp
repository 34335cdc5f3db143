// SPDX-License-Identifier: Apache-2.0
#include "core/frame_ring.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace dts::core {
namespace {

constexpr std::size_t kScans = 3;

const std::vector<bool> kShort{false, false, true};

Frame prototype() { return {.streams = {Block(2, kScans), Block(0, kScans), Block(1, kScans)}}; }

/// A frame of `scans` scans whose values tell them apart.
Frame frame_of(std::uint64_t number, std::size_t scans = kScans) {
  Frame frame = prototype();
  frame.segment = 1;
  frame.host_time_ns = static_cast<std::int64_t>(1000 * number);
  for (Block& block : frame.streams) {
    block.set_count(scans);
    block.segment = 1;
    block.first_scan = {number * kScans};
    block.host_time_ns = static_cast<std::int64_t>(number) - 5;
    block.host_time_uncertainty_ns = 77;
    block.clock_drift_ppm = -0.5;
    block.sequence = number;
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      for (std::size_t scan = 0; scan < scans; ++scan) {
        block.column(channel)[scan] = static_cast<double>(number) + 0.1 * static_cast<double>(channel) + 0.01 * static_cast<double>(scan);
        block.quality(channel)[scan] = static_cast<std::uint8_t>(16 * channel + scan);
      }
    }
  }
  return frame;
}

FrameEvents triggers(std::size_t count) {
  FrameEvents events;
  for (std::size_t trigger = 0; trigger < count; ++trigger) events.triggers.push({.scan = {trigger}});
  return events;
}

TEST(FrameRing, FrameAndItsEvents_ArriveUnchanged) {
  FrameRing ring(4, prototype(), kShort);
  FrameReader reader(ring, 4);
  EXPECT_EQ(reader.front(), nullptr);
  Frame sent = frame_of(7, 2);
  sent.streams[2].column(0)[1] = std::nan("");
  sent.lost_scans_total = 9;
  FrameEvents events = triggers(2);
  events.reaches.push({.number = 5});
  ring.write(sent, events);

  const Frame* const got = reader.front();
  ASSERT_NE(got, nullptr);
  EXPECT_EQ(reader.front(), got) << "the same until it is released";
  EXPECT_EQ(got->segment, 1U);
  EXPECT_EQ(got->host_time_ns, 7000);
  EXPECT_EQ(got->lost_scans_total, 9U);
  EXPECT_EQ(got->gap_before.reason, GapReason::None);
  for (std::size_t stream = 0; stream < 3; ++stream) {
    const Block& block = got->streams[stream];
    const Block& expected = sent.streams[stream];
    ASSERT_EQ(block.count(), 2U);
    EXPECT_EQ(block.segment, 1U);
    EXPECT_EQ(block.first_scan.value, 21U);
    EXPECT_EQ(block.host_time_ns, 2);
    EXPECT_EQ(block.host_time_uncertainty_ns, 77);
    EXPECT_EQ(block.clock_drift_ppm, -0.5);
    EXPECT_EQ(block.sequence, 7U);
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      for (std::size_t scan = 0; scan < 2; ++scan) {
        const double value = expected.column(channel)[scan];
        const double kept = stream == 2 ? static_cast<float>(value) : value;
        EXPECT_TRUE(block.column(channel)[scan] == kept || (std::isnan(kept) && std::isnan(block.column(channel)[scan])));
        EXPECT_EQ(block.quality(channel)[scan], expected.quality(channel)[scan]);
      }
    }
  }
  ASSERT_EQ(reader.events().size(), 3U);
  EXPECT_EQ(std::get<TriggerEvent>(reader.events()[1]).scan.value, 1U);
  EXPECT_EQ(std::get<ReachEvent>(reader.events()[2]).number, 5U);
  reader.release();
  EXPECT_EQ(reader.front(), nullptr);
  EXPECT_EQ(reader.lost_frames() + reader.lost_scans() + reader.lost_events(), 0U);
}

/// The numbers of the frames that a reader still gets, and what it lost.
std::string rest_of(FrameReader& reader) {
  std::string text;
  for (const Frame* frame = reader.front(); frame != nullptr; frame = reader.front()) {
    text += std::to_string(frame->streams[0].sequence) + ' ';
    reader.release();
  }
  return text + "lost " + std::to_string(reader.lost_frames()) + " frames, " + std::to_string(reader.lost_scans()) + " scans, " +
         std::to_string(reader.lost_events()) + " events";
}

TEST(FrameRing, ReaderThatIsLate_SkipsToNewerFrames_AndKnowsExactlyWhatItLost) {
  RecordProperty("requirement", "ACQ-12");
  FrameRing ring(8, prototype(), kShort);
  FrameReader patient(ring, 8);
  FrameReader hurried(ring, 4);
  FrameReader prompt(ring, 8);
  std::string all;
  for (std::uint64_t number = 0; number < 9; ++number) {
    ring.write(frame_of(number, number == 2 ? 1 : kScans), triggers(number == 3 ? 2 : 0));
    if (const Frame* const frame = prompt.front()) all += std::to_string(frame->streams[0].sequence);
    prompt.release();
  }
  EXPECT_EQ(all, "012345678");
  EXPECT_EQ(patient.waiting(), 9U);
  EXPECT_EQ(rest_of(prompt), "lost 0 frames, 0 scans, 0 events");
  EXPECT_EQ(rest_of(patient), "5 6 7 8 lost 5 frames, 13 scans, 2 events");
  EXPECT_EQ(rest_of(hurried), "7 8 lost 7 frames, 19 scans, 2 events");
}

TEST(FrameRing, EventsThatFoundNoRoom_AreLostForEachReader) {
  FrameRing ring(8, prototype(), kShort);
  FrameReader reader(ring, 8);
  ring.write(frame_of(0), triggers(kMaxTriggersPerFrame + 3));
  EXPECT_EQ(rest_of(reader), "0 lost 0 frames, 0 scans, 3 events");
  for (std::size_t frame = 0; frame <= FrameRing::kEvents / kMaxTriggersPerFrame; ++frame)
    ring.write(frame_of(1), triggers(kMaxTriggersPerFrame));
  FrameRing few(256, prototype(), kShort);
  FrameReader late(few, 256);
  for (std::size_t frame = 0; frame < 129; ++frame) few.write(frame_of(frame), triggers(kMaxTriggersPerFrame));
  std::size_t events = 0;
  for (; late.front() != nullptr; late.release()) events += late.events().size();
  EXPECT_EQ(events, FrameRing::kEvents);
  EXPECT_EQ(late.lost_events(), 16U) << "the ring of events is shorter";
  EXPECT_EQ(late.lost_frames(), 0U);
}

TEST(FrameRing, GapsOfLostFrames_AreOneGapBeforeTheNextFrame) {
  struct Row {
    GapReason reason;
    std::uint64_t missing;
    bool is_exact;
  };
  FrameRing ring(8, prototype(), kShort);
  FrameReader late(ring, 2);
  FrameReader prompt(ring, 8);
  std::uint64_t lost_scans = 0;
  std::uint64_t number = 0;
  const auto write = [&](std::uint32_t segment, const Gap& gap) {
    Frame frame = frame_of(number++);
    frame.segment = segment;
    frame.gap_before = gap;
    frame.lost_scans_total = lost_scans += gap.missing_scans;
    ring.write(frame, {});
  };
  write(1, {});
  ASSERT_NE(late.front(), nullptr);
  late.release();
  write(2, {.reason = GapReason::Overrun, .missing_scans = 100, .is_exact = true});
  write(3, {.reason = GapReason::Stall, .missing_scans = 50, .is_exact = true});
  write(3, {});
  write(3, {});
  for (const Row& expected : {Row{GapReason::None, 0, false}, Row{GapReason::Overrun, 100, true}, Row{GapReason::Stall, 50, true},
                              Row{GapReason::None, 0, false}}) {
    const Gap& gap = prompt.front()->gap_before;
    EXPECT_EQ(gap.reason, expected.reason);
    EXPECT_EQ(gap.missing_scans, expected.missing);
    EXPECT_EQ(gap.is_exact, expected.is_exact);
    prompt.release();
  }
  const Gap& gap = late.front()->gap_before;
  EXPECT_EQ(gap.reason, GapReason::Stall);
  EXPECT_EQ(gap.missing_scans, 150U);
  EXPECT_FALSE(gap.is_exact) << "not of one gap";
  late.release();
  EXPECT_EQ(late.front(), nullptr);
}

TEST(FrameRing, StartAt_ContinuesThereWithoutLosses) {
  FrameRing ring(8, prototype(), kShort);
  FrameReader reader(ring, 8);
  ring.write(frame_of(0), triggers(1));
  const FramePosition middle = ring.end();
  ring.write(frame_of(1), triggers(1));
  reader.start_at(middle);
  EXPECT_EQ(rest_of(reader), "1 lost 0 frames, 0 scans, 0 events");
  EXPECT_EQ(reader.position().frame, 2U);
  EXPECT_EQ(reader.position().scans, 2 * kScans);
  EXPECT_EQ(reader.position().events, 2U);
}

TEST(FrameRing, Memory_IsLimited) {
  const FrameRing small(1000, prototype(), kShort);
  EXPECT_EQ(small.capacity(), 1000U);
  const Frame large{.streams = {Block(32, 4096)}};
  const FrameRing bounded(100'000, large, {false});
  EXPECT_EQ(bounded.capacity(), 31U) << "of 1.2 MB each";
}

}  // namespace
}  // namespace dts::core
