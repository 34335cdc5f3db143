// SPDX-License-Identifier: Apache-2.0
// The way from the pipeline thread to the file, with frames made by hand: what is lost on it, and what happens to the file meanwhile.
#include "session/record_thread.h"
#include "support/event_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <functional>
#include <thread>
#include <utility>

#include "core/doorbell.h"
#include "floor_config.h"
#include "record/recording.h"
#include "record/xdf/recovery.h"
#include "session/rig.h"
#include "session/rig_pipeline.h"

namespace dts::session {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kBlockScans = 30;

class RecordThreadTest : public testing::Test {
 protected:
  RecordThreadTest() : rig_(Rig::create(floor_config("sim:floor?truth=0", kBlockScans), clock_, bell_).value()) {
    std::string name = (std::filesystem::temp_directory_path() / "dts-record-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    auto made = make_rig_pipeline(rig_->config(), rig_->device());
    pipeline_ = std::move(made->pipeline);
    tare_ = std::move(made->tare);
    frame_ = pipeline_->make_frame();
    storage_ = {.directory = folder_.string(), .refuse_below_min = 0.0, .warn_below_min = 0.0, .stop_below_mib = 0.0};
    std::filesystem::create_directory(sessions_directory(storage_));
  }
  ~RecordThreadTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::string file(const std::string& name) const { return sessions_directory(storage_) + "/" + name + ".xdf"; }

  /// Begins a recording of what is offered to the tap from now on.
  void begin(RecordThread& thread, const std::string& rig, RecordTap& tap) {
    auto recorder = record::Recorder::create(file(rig), {.session_id = rig, .rig = rig},
                                             recorded_streams(rig_->config(), rig_->device(), pipeline_->formats()));
    ASSERT_TRUE(recorder);
    thread.begin(rig, std::move(*recorder), file(rig), tap.next_take());
    tap.open();
    tap.follow();
  }
  static core::Frame& at(core::Frame& frame, std::uint32_t segment, std::uint64_t first) {
    frame.segment = segment;
    for (core::Block& block : frame.streams) {
      block.segment = segment;
      block.first_scan = {first};
      block.host_time_ns = 1'000'000'000 + static_cast<std::int64_t>(segment) * 60'000'000'000 + static_cast<std::int64_t>(first) * 666'667;
      block.set_count(kBlockScans);
    }
    return frame;
  }
  [[nodiscard]] static FinishedRecording wait(RecordThread& thread) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      if (auto finished = thread.take_finished(); !finished.empty()) return finished.front();
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    ADD_FAILURE() << "no recording has ended";
    return {};
  }

  core::SystemClock clock_;
  core::Doorbell bell_;
  std::unique_ptr<Rig> rig_;
  std::unique_ptr<pipeline::Tare> tare_;
  std::unique_ptr<pipeline::Pipeline> pipeline_;
  core::Frame frame_;
  std::filesystem::path folder_;
  StorageConfig storage_;
};

TEST_F(RecordThreadTest, EndThatFoundNoRoom_IsALossAlthoughNoScanFollows) {
  RecordTap tap(4, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  for (std::uint64_t block = 0; block < 6; ++block) tap.offer(at(frame_, 1, block * kBlockScans));  // room for four
  tap.close();
  thread.start();
  while (thread.view("floor").is_recording) tap.follow();  // as the pipeline thread does: the end mark goes when there is room
  const FinishedRecording finished = wait(thread);

  EXPECT_EQ(finished.incomplete, "60 scans were dropped: the queue to the recorder was full");
  EXPECT_EQ(thread.view("floor").lost_scans, 60U);
  EXPECT_EQ(record::verify(finished.file).value().incomplete, finished.incomplete);
}

TEST_F(RecordThreadTest, EndOfASegmentThatFoundNoRoom_IsALossWhereItWasLost_AlthoughScansStartAnew) {
  RecordTap tap(4, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  for (std::uint64_t block = 0; block < 5; ++block) tap.offer(at(frame_, 1, block * kBlockScans));
  thread.start();
  while (tap.is_blocked()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  tap.offer(at(frame_, 2, 0));
  tap.close();
  while (thread.view("floor").is_recording) tap.follow();
  const FinishedRecording finished = wait(thread);

  EXPECT_EQ(finished.incomplete, "30 scans were dropped: the queue to the recorder was full");
  const auto recording = record::Recording::open(finished.file).value();
  std::vector<v1::Event> losses;
  while (const auto item = recording->next().value()) {
    const auto* timed = std::get_if<record::TimedEvent>(&*item);
    if (timed != nullptr && timed->event.has_loss()) losses.push_back(timed->event);
  }
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].segment(), 1U);
  EXPECT_EQ(losses[0].scan(), 4 * kBlockScans);
}

/// Time that passes only when the record thread sleeps: `on_turn` runs in it, once a turn, for as many turns as wanted.
class TurnClock final : public core::Clock {
 public:
  explicit TurnClock(int turns) : left_(turns) {}
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return now_ns_; }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override {
    if (left_ == 0) return std::this_thread::sleep_for(std::chrono::milliseconds(1));
    on_turn();
    now_ns_ = deadline_ns;
    --left_;
  }
  [[nodiscard]] bool is_over() const { return left_ == 0; }
  std::function<void()> on_turn;

 private:
  std::atomic<std::int64_t> now_ns_{1'000'000'000'000};
  std::atomic<int> left_;
};

TEST_F(RecordThreadTest, WhatIsTaken_IsWrittenSoon_AndNotAtEveryTurn) {
  TurnClock turns(100);
  RecordTap tap(64, *pipeline_);
  RecordThread thread(turns, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  std::uint64_t first = 0;
  std::uintmax_t bytes = std::filesystem::file_size(file("floor") + ".part");
  std::vector<std::int64_t> written_ns{turns.now_ns()};
  turns.on_turn = [&] {
    const auto now_bytes = std::filesystem::file_size(file("floor") + ".part");
    if (std::exchange(bytes, now_bytes) == now_bytes && first > 0) return;
    if (first > 0) written_ns.push_back(turns.now_ns());
    for (core::Block& block : at(frame_, 1, first).streams) block.set_count(&block == &frame_.streams.front() ? 1 : 0);
    tap.offer(frame_);  // the next frame comes when the one before is in the file
    ++first;
  };
  thread.start();
  while (!turns.is_over()) std::this_thread::yield();
  thread.stop();

  EXPECT_GE(written_ns.size(), 16U) << "in 4 s";
  EXPECT_LE(written_ns.size(), 60U) << "chunks of a few scans at each of the 100 turns make a file large";
  for (std::size_t i = 1; i < written_ns.size(); ++i) {
    EXPECT_LE(static_cast<double>(written_ns[i] - written_ns[i - 1]) * 1e-9, record::kLongestUnwrittenS);
  }
}

TEST_F(RecordThreadTest, DiskNearlyFull_EndsTheRecordingAsThat) {
  TurnClock turns(10);
  storage_.stop_below_mib = 1e9;  // more than any disk has
  RecordTap tap(64, *pipeline_);
  RecordThread thread(turns, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  turns.on_turn = [&] { tap.offer(at(frame_, 1, 0)); };
  thread.start();
  while (!turns.is_over()) std::this_thread::yield();

  const auto finished = thread.take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].incomplete, "the disk is nearly full");
}

TEST_F(RecordThreadTest, Lag_GrowsUntilWhatWasTakenIsOnTheDisk) {
  core::VirtualClock clock(5'000'000'000);
  RecordTap tap(64, *pipeline_);
  RecordThread thread(clock, storage_);
  thread.add("floor", tap);
  EXPECT_EQ(thread.view("floor").lag_s, 0.0);
  begin(thread, "floor", tap);
  clock.advance_ns(700'000'000);
  EXPECT_DOUBLE_EQ(thread.view("floor").lag_s, 0.7);
  thread.mark_incomplete("floor", "as marked");
  thread.post("floor", test::event_of("marker {}"));
  tap.offer(at(frame_, 1, 0));
  tap.close();
  tap.follow();
  thread.start();
  const FinishedRecording finished = wait(thread);
  thread.wait_until_closed(std::chrono::milliseconds(0));

  EXPECT_EQ(finished.incomplete, "as marked");
  EXPECT_EQ(finished.scans, kBlockScans);
  EXPECT_NEAR(finished.duration_s, kBlockScans / 1500.0, 1e-9);
  const RecordingView view = thread.view("floor");
  EXPECT_FALSE(view.is_recording);
  EXPECT_EQ(view.lag_s, 0.0);
  EXPECT_EQ(view.file, finished.file);
  EXPECT_EQ(view.bytes, std::filesystem::file_size(finished.file));
  EXPECT_EQ(view.problem, "as marked");
}

TEST_F(RecordThreadTest, GapsBeforeFramesThatFoundNoRoom_AddUp) {
  RecordTap tap(1, *pipeline_);
  tap.open();
  tap.follow();
  while (!tap.is_blocked()) tap.offer(at(frame_, 1, 0));
  const auto offer = [&](std::uint32_t segment, const core::Gap& gap) {
    at(frame_, segment, 0).gap_before = gap;
    tap.offer(frame_);
  };
  offer(2, {.reason = core::GapReason::Overrun, .missing_scans = 100, .is_exact = true});
  offer(3, {.reason = core::GapReason::Silence, .missing_scans = 50, .is_exact = false});
  while (tap.front() != nullptr) tap.release();
  offer(4, {.reason = core::GapReason::Stall, .missing_scans = 7, .is_exact = true});

  ASSERT_NE(tap.front(), nullptr);
  const core::Gap& gap = tap.front()->frame.gap_before;
  EXPECT_EQ(gap.reason, core::GapReason::Stall);
  EXPECT_EQ(gap.missing_scans, 157U);
  EXPECT_FALSE(gap.is_exact);
  EXPECT_EQ(tap.front()->lost_scans, 2 * kBlockScans);
}

TEST_F(RecordThreadTest, EventsTravelWithTheirFrame_OrAreDroppedWithIt) {
  RecordTap tap(1, *pipeline_);
  core::FrameEvents trigger;
  trigger.triggers.push({.segment = 1});
  tap.offer(at(frame_, 1, 0), trigger);
  EXPECT_EQ(tap.events().front(), nullptr) << "nothing is recorded";
  tap.open();
  tap.follow();
  while (!tap.is_blocked()) tap.offer(at(frame_, 1, 0), trigger);
  tap.offer(at(frame_, 1, kBlockScans), trigger);  // finds no room
  std::uint32_t counted = 0;
  for (; tap.front() != nullptr; tap.release()) counted += tap.front()->frame.event_count;
  EXPECT_EQ(counted, tap.capacity());
  for (std::uint32_t event = 0; event < counted; ++event, tap.events().release()) ASSERT_NE(tap.events().front(), nullptr);
  EXPECT_EQ(tap.events().front(), nullptr);
}

TEST_F(RecordThreadTest, EventsThatFoundNoRoom_MakeTheRecordingIncomplete) {
  RecordTap tap(256, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  core::FrameEvents triggers;
  for (int trigger = 0; trigger < 16; ++trigger) triggers.triggers.push({.segment = 1});
  for (std::uint64_t block = 0; block < 129; ++block) tap.offer(at(frame_, 1, block * kBlockScans), triggers);
  tap.close();
  tap.follow();
  thread.start();

  EXPECT_EQ(wait(thread).incomplete, "16 events were dropped: the queue to the recorder was full");
}

TEST_F(RecordThreadTest, RecordingWhoseFileIsRemoved_EndsAtOnce) {
  RecordTap tap(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  thread.start();
  tap.offer(at(frame_, 1, 0));
  std::filesystem::remove_all(sessions_directory(storage_));

  const FinishedRecording finished = wait(thread);  // nobody has ended the take

  EXPECT_FALSE(finished.is_closed);
  EXPECT_THAT(finished.incomplete, HasSubstr("was deleted or moved"));
}

TEST_F(RecordThreadTest, NameTakenMeanwhile_WhatStaysSaysThatItIsIncomplete) {
  RecordTap tap(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  tap.offer(at(frame_, 1, 0));
  std::filesystem::create_directory(file("floor"));
  tap.close();
  tap.follow();
  thread.start();

  const FinishedRecording finished = wait(thread);

  EXPECT_FALSE(finished.is_closed);
  EXPECT_THAT(record::verify(finished.file).value().incomplete, HasSubstr("exists already"));
}

TEST_F(RecordThreadTest, RigThatNeverRests_LeavesTheOthersTheirTurn) {
  RecordTap busy(512, *pipeline_);
  RecordTap calm(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("busy", busy);
  thread.add("calm", calm);
  begin(thread, "busy", busy);
  begin(thread, "calm", calm);
  std::atomic<bool> is_full = false;
  std::atomic<bool> is_over = false;
  std::jthread producer([&] {
    core::Frame frame = pipeline_->make_frame();
    for (std::uint64_t first = 0; !is_over; first += kBlockScans) {
      while (busy.is_blocked() && !is_over) {
        is_full = true;
        std::this_thread::yield();
      }
      busy.offer(at(frame, 1, first));
    }
  });
  while (!is_full) std::this_thread::yield();
  thread.start();
  calm.offer(at(frame_, 1, 0));
  calm.close();
  calm.follow();

  EXPECT_EQ(wait(thread).rig, "calm");

  thread.stop();  // also ends while that rig goes on
  is_over = true;
}

TEST_F(RecordThreadTest, RecordingEndedByTheDaemon_HoldsWhatWasStillBuffered) {
  RecordTap tap(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", tap);
  begin(thread, "floor", tap);
  tap.offer(at(frame_, 1, 0));
  thread.start();
  thread.stop();

  const FinishedRecording finished = wait(thread);

  EXPECT_TRUE(finished.is_closed);
  EXPECT_EQ(finished.scans, kBlockScans);
  EXPECT_THAT(finished.incomplete, HasSubstr("daemon stopped"));
}

}  // namespace
}  // namespace dts::session
