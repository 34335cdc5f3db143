// SPDX-License-Identifier: Apache-2.0
// What `read` promises while bytes arrive without end.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "device/board/board_device.h"
#include "device/board/frames.h"
#include "unit/device/board/board_rig.h"

namespace dts::device::board::test {
namespace {

/// A link whose other end never stops: it sends `flood` again and again, 1 ms for each read.
class FloodingLink final : public bytes::ByteLink {
 public:
  explicit FloodingLink(core::VirtualClock& clock) : clock_(clock) {}
  std::string flood;

  [[nodiscard]] core::Status open() override { return {}; }
  void close() noexcept override {}
  [[nodiscard]] bytes::BytesRead read(std::span<std::uint8_t> buffer, std::int64_t) noexcept override {
    clock_.advance_ns(kMs);
    if (++reads_ > kMostReads) return {bytes::ReadEnd::Lost, 0, 0};
    std::size_t count = 0;
    while (count + flood.size() <= buffer.size()) {
      std::copy(flood.begin(), flood.end(), buffer.begin() + static_cast<std::ptrdiff_t>(count));
      count += flood.size();
    }
    return {bytes::ReadEnd::Bytes, count, clock_.raw_ns()};
  }
  [[nodiscard]] core::Status write(std::span<const std::uint8_t>) override { return {}; }
  void interrupt() noexcept override {}
  [[nodiscard]] bool has_arrived() noexcept override { return false; }
  [[nodiscard]] Facts facts() const override { return {}; }
  [[nodiscard]] std::string why_lost() const override { return {}; }
  [[nodiscard]] bool restarts_the_board() const noexcept override { return false; }

 private:
  static constexpr int kMostReads = 20'000;  ///< Then it ends, so that a failing test does.
  core::VirtualClock& clock_;
  int reads_ = 0;
};

std::string text_of(const EncodedFrame& frame) { return {frame.view().begin(), frame.view().end()}; }

/// A device whose board sends nothing but what is no scan.
struct Flooded {
  explicit Flooded(const std::string& text) : link(clock) {
    link.flood = text;
    source = std::make_unique<LineSource>(input, timeline, clock, LineShape{.channels = 4, .highest = 5.0}, 64);
    timeline.start(rate_of(100.0), 0, false, std::nullopt);
  }
  core::VirtualClock clock{1000 * kSecond};
  FloodingLink link;
  LineInput input{link, clock, LineDecoder(4, FirstColumn::Value, 32)};
  Timeline timeline;
  std::unique_ptr<ScanSource> source;
  std::atomic<bool> is_interrupted{false};
  core::Block block{4, 64};
};

TEST(ScanDelivery, LinesWithoutAScan_DoNotKeepTheReader) {
  for (const char* const text : {"x\n", "1,2,3\n", "x"}) {
    Flooded flooded(text);
    ScanDelivery delivery(*flooded.source, flooded.clock, flooded.is_interrupted, 64);
    const std::int64_t deadline_ns = flooded.clock.now_ns() + 200 * kMs;
    EXPECT_EQ(delivery.read(flooded.block, deadline_ns).outcome, ReadOutcome::Timeout) << text;
    EXPECT_LE(flooded.clock.now_ns(), deadline_ns + 5 * kMs) << text;
  }
}

TEST(ScanDelivery, LinesWithoutAScan_AreSilence) {
  Flooded flooded("1,2,3\n");
  ScanDelivery delivery(*flooded.source, flooded.clock, flooded.is_interrupted, 64);
  const std::int64_t begin_ns = flooded.clock.now_ns();
  const ReadResult gone = delivery.read(flooded.block, kNoDeadline);
  EXPECT_EQ(gone.outcome, ReadOutcome::Gone);
  EXPECT_EQ(gone.gap.reason, core::GapReason::Silence);
  EXPECT_NEAR(static_cast<double>(flooded.clock.now_ns() - begin_ns) * 1e-9, 1.02 + 0.5 + 1.02, 0.1);
}

TEST(ScanDelivery, Interrupt_IsSeenAmongLinesWithoutAScan) {
  Flooded flooded("x\n");
  ScanDelivery delivery(*flooded.source, flooded.clock, flooded.is_interrupted, 64);
  const std::int64_t begin_ns = flooded.clock.now_ns();
  flooded.is_interrupted = true;
  EXPECT_EQ(delivery.read(flooded.block, kNoDeadline).outcome, ReadOutcome::Timeout);
  EXPECT_LE(flooded.clock.now_ns(), begin_ns + 100 * kMs);
}

/// What has arrived is delivered also if the caller is late.
TEST(ScanDelivery, DeadlineThatHasPassed_DeliversWhatHasArrived) {
  Flooded flooded("1,2,3,4\n");
  ScanDelivery delivery(*flooded.source, flooded.clock, flooded.is_interrupted, 64);
  ASSERT_EQ(delivery.read(flooded.block, flooded.clock.now_ns() - kSecond).outcome, ReadOutcome::Scans);
  EXPECT_EQ(flooded.block.count(), 64U);
}

TEST(ScanDelivery, MessagesWithoutAScan_DoNotKeepTheReader) {
  core::VirtualClock clock{1000 * kSecond};
  FloodingLink link(clock);
  std::vector<std::uint8_t> log{5, 'h', 'o', 't'};
  link.flood = text_of(encode_frame(log));
  FrameInput input(link, clock);
  BoardFacts facts;
  ASSERT_EQ(facts.add(Descriptor{.channels = 1}), BoardFacts::Change::Learned);
  ASSERT_TRUE(facts.add(Channel{}).has_value());
  Timeline timeline;
  timeline.start(rate_of(100.0), 0, false, std::nullopt);
  FrameSource source(link, input, facts, timeline, clock, {}, 64);
  std::atomic<bool> is_interrupted{false};
  ScanDelivery delivery(source, clock, is_interrupted, 64);
  core::Block block(1, 64);
  const std::int64_t deadline_ns = clock.now_ns() + 200 * kMs;
  EXPECT_EQ(delivery.read(block, deadline_ns).outcome, ReadOutcome::Timeout);
  EXPECT_LE(clock.now_ns(), deadline_ns + 5 * kMs);
}

}  // namespace
}  // namespace dts::device::board::test
