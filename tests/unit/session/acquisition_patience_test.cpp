// SPDX-License-Identifier: Apache-2.0
// A device whose scans wait for their reader, as a replay's do: a slow pipeline loses nothing.
#include <gtest/gtest.h>

#include <functional>
#include <tuple>
#include <vector>

#include "session/acquisition.h"
#include "support/test_device.h"

namespace dts::session {
namespace {

constexpr std::size_t kScans = 4;

/// Time passes when somebody sleeps, and then something else happens too.
class VisitedClock final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return clock_.now_ns(); }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    clock_.sleep_until_ns(deadline_ns);
    on_sleep();
  }

  std::function<void()> on_sleep = [] {};

 private:
  core::VirtualClock clock_{1'000'000'000};
};

/// Gives `blocks` blocks as fast as they are read, then runs `on_end`.
class PatientDevice final : public device::TestDevice {
 public:
  explicit PatientDevice(std::size_t blocks) : left_(blocks) {
    description_.channels.resize(1);
    description_.waits_for_reader = true;
  }

  std::function<void()> on_end = [] {};
  std::size_t gap_before_left = 0;  ///< A gap comes when so many blocks are left; 0: none.

  void begin_at(std::uint64_t scan) { description_.recorded_pipeline.first_scan = scan; }

  device::ReadResult read(core::Block& block, std::int64_t) noexcept override {
    if (left_ == 0) {
      on_end();
      return {.outcome = device::ReadOutcome::Timeout, .gap = {}};
    }
    if (left_ == gap_before_left) {
      gap_before_left = 0;
      return without_scans(device::ReadOutcome::Gap, {.reason = core::GapReason::Silence, .missing_scans = 3, .is_exact = true});
    }
    --left_;
    block.set_count(kScans);
    block.first_scan = {index_};
    block.host_time_ns = static_cast<std::int64_t>(index_) * 10'000'000;
    index_ += kScans;
    return {.outcome = device::ReadOutcome::Scans, .gap = {}};
  }

 private:
  std::size_t left_;
};

struct Bench : ScanSink {
  explicit Bench(std::size_t blocks) : device(blocks) {}

  PatientDevice device;
  VisitedClock clock;
  Acquisition acquisition{device, clock, *this, core::Rate::create(100, 1).value(), kScans};
  std::vector<std::tuple<std::uint32_t, std::uint64_t, core::GapReason>> seen;
  int room = 2;  ///< Blocks that still find room. One more at every sleep.

  [[nodiscard]] bool has_room() noexcept override { return room > 0; }
  void process(const core::Acquired& acquired, bool /*has_more*/) noexcept override {
    --room;
    seen.emplace_back(acquired.block.segment, acquired.block.first_scan.value, acquired.gap_before.reason);
  }

  /// Segment, first scan and reason of the gap before, of each block.
  std::vector<std::tuple<std::uint32_t, std::uint64_t, core::GapReason>> run() {
    clock.on_sleep = [&] { ++room; };
    device.on_end = [&] { acquisition.request_stop(); };
    acquisition.run();
    return seen;
  }
};

TEST(AcquisitionOfAPatientDevice, SlowPipeline_LosesNothing) {
  Bench bench(50);
  const auto seen = bench.run();

  ASSERT_EQ(seen.size(), 50U);
  for (std::size_t block = 0; block < seen.size(); ++block) EXPECT_EQ(seen[block], std::tuple(0U, block * kScans, core::GapReason::None));
  EXPECT_EQ(bench.acquisition.report().losses.total().gaps, 0U);
}

TEST(AcquisitionOfAPatientDevice, RecordingFromTheMiddleOfASegment_BeginsAtItsIndexAndSegmentsBehindItAtZero) {
  Bench bench(4);
  bench.device.begin_at(77);
  bench.device.gap_before_left = 2;
  using enum core::GapReason;
  const std::vector<std::tuple<std::uint32_t, std::uint64_t, core::GapReason>> expected{
      {0, 77, None}, {0, 77 + kScans, None}, {1, 0, Silence}, {1, kScans, None}};
  EXPECT_EQ(bench.run(), expected);
  EXPECT_EQ(bench.acquisition.report().losses.total().gaps, 1U);
}

TEST(AcquisitionOfAPatientDevice, WaitForRoom_IsASignOfLife) {
  Bench bench(50);
  std::vector<std::uint64_t> turns;
  bench.clock.on_sleep = [&] {
    turns.push_back(bench.acquisition.report().turns);
    if (turns.size() == 5) bench.acquisition.request_stop();
  };

  bench.acquisition.run();

  EXPECT_EQ(turns, (std::vector<std::uint64_t>{0, 1, 2, 3, 4}));
}

TEST(AcquisitionOfAPatientDevice, StopWhileItWaitsForRoom_IsSeenWithin100Milliseconds) {
  Bench bench(50);
  std::int64_t stopped_at_ns = 0;
  int sleeps = 0;
  bench.clock.on_sleep = [&] {
    if (++sleeps != 5) return;
    stopped_at_ns = bench.clock.now_ns();
    bench.acquisition.request_stop();
  };

  bench.acquisition.run();

  EXPECT_GT(stopped_at_ns, 0);
  EXPECT_LE(bench.clock.now_ns() - stopped_at_ns, 100'000'000);
}

}  // namespace
}  // namespace dts::session
