// SPDX-License-Identifier: Apache-2.0
// The way from the ring of frames to the file, with frames made by hand: what is lost on it, and what happens to the file meanwhile.
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

  /// A ring with its tap, written by the test instead of a rig's thread.
  struct Line {
    Line(std::size_t frames, const pipeline::Pipeline& pipeline)
        : ring(frames, pipeline.make_frame(), std::vector<bool>(pipeline.formats().size())), tap(ring, pipeline) {}
    core::FrameRing ring;
    RecordTap tap;

    void write(const core::Frame& frame, const core::FrameEvents& events = {}) { ring.write(frame, events); }
    void close() { tap.close(ring.end()); }
  };

  /// Begins a recording of what is written from now on.
  void begin(RecordThread& thread, const std::string& rig, Line& line) {
    RecordTap& tap = line.tap;
    auto recorder = record::Recorder::create(file(rig), {.session_id = rig, .rig = rig},
                                             recorded_streams(rig_->config(), rig_->device(), pipeline_->formats()));
    ASSERT_TRUE(recorder);
    thread.begin(rig, std::move(*recorder), file(rig), tap.next_take());
    tap.open();
    tap.begin_take();
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

TEST_F(RecordThreadTest, FramesThatAreOverwritten_AreALoss_AlsoAtTheEnd) {
  Line line(4, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  for (std::uint64_t block = 0; block < 6; ++block) line.write(at(frame_, 1, block * kBlockScans));  // the ring has four
  line.close();
  thread.start();
  const FinishedRecording finished = wait(thread);

  EXPECT_EQ(finished.incomplete, "120 scans were dropped: the queue to the recorder was full") << "it continues with the newer half";
  EXPECT_EQ(thread.view("floor").lost_scans, 4 * kBlockScans);
  EXPECT_EQ(record::verify(finished.file).value().incomplete, finished.incomplete);
}

TEST_F(RecordThreadTest, EndThatWasPassed_CountsTheLossUpToIt) {
  Line line(4, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  for (std::uint64_t block = 0; block < 3; ++block) line.write(at(frame_, 1, block * kBlockScans));
  line.close();
  for (std::uint64_t block = 3; block < 9; ++block) line.write(at(frame_, 1, block * kBlockScans));  // the rig streams on
  thread.start();

  EXPECT_EQ(wait(thread).incomplete, "90 scans were dropped: the queue to the recorder was full");
}

TEST_F(RecordThreadTest, TakeThatEndsBeforeAnyFrame_IsARecordingWithoutScans_AndTheNextOneIsComplete) {
  Line line(4, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  auto recorder = record::Recorder::create(file("none"), {.session_id = "none", .rig = "floor"},
                                           recorded_streams(rig_->config(), rig_->device(), pipeline_->formats()));
  ASSERT_TRUE(recorder);
  thread.begin("floor", std::move(*recorder), file("none"), line.tap.next_take());
  line.tap.open();
  line.close();
  thread.start();
  EXPECT_EQ(wait(thread).incomplete, "the device delivered no scan");
  line.tap.begin_take();  // the rig's thread comes too late
  line.write(at(frame_, 1, 0));
  begin(thread, "floor", line);
  line.write(at(frame_, 1, kBlockScans));
  line.close();

  const FinishedRecording finished = wait(thread);
  EXPECT_EQ(finished.incomplete, "");
  EXPECT_EQ(finished.scans, kBlockScans);
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

TEST_F(RecordThreadTest, EndOfASegmentThatIsOverwritten_IsALossWhereItWasLost_AlthoughScansStartAnew) {
  TurnClock turns(3);
  Line line(4, *pipeline_);
  RecordThread thread(turns, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  int turn = 0;
  turns.on_turn = [&] {
    if (++turn == 1) {
      for (std::uint64_t block = 0; block < 2; ++block) line.write(at(frame_, 1, block * kBlockScans));
    } else if (turn == 2) {
      for (std::uint64_t block = 2; block < 5; ++block) line.write(at(frame_, 1, block * kBlockScans));
      for (std::uint64_t block = 0; block < 2; ++block) line.write(at(frame_, 2, block * kBlockScans));
      line.close();
    }
  };
  thread.start();
  const FinishedRecording finished = wait(thread);

  EXPECT_EQ(finished.incomplete, "90 scans were dropped: the queue to the recorder was full");
  const auto recording = record::Recording::open(finished.file).value();
  std::vector<v1::Event> losses;
  while (const auto item = recording->next().value()) {
    const auto* timed = std::get_if<record::TimedEvent>(&*item);
    if (timed != nullptr && timed->event.has_loss()) losses.push_back(timed->event);
  }
  ASSERT_EQ(losses.size(), 1U);
  EXPECT_EQ(losses[0].segment(), 1U);
  EXPECT_EQ(losses[0].scan(), 2 * kBlockScans);
}

TEST_F(RecordThreadTest, WhatIsTaken_IsWrittenSoon_AndNotAtEveryTurn) {
  TurnClock turns(100);
  Line line(64, *pipeline_);
  RecordThread thread(turns, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  std::uint64_t first = 0;
  std::uintmax_t bytes = std::filesystem::file_size(file("floor") + ".part");
  std::vector<std::int64_t> written_ns{turns.now_ns()};
  turns.on_turn = [&] {
    const auto now_bytes = std::filesystem::file_size(file("floor") + ".part");
    if (std::exchange(bytes, now_bytes) == now_bytes && first > 0) return;
    if (first > 0) written_ns.push_back(turns.now_ns());
    for (core::Block& block : at(frame_, 1, first).streams) block.set_count(&block == &frame_.streams.front() ? 1 : 0);
    line.write(frame_);  // the next frame comes when the one before is in the file
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
  Line line(64, *pipeline_);
  RecordThread thread(turns, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  turns.on_turn = [&] { line.write(at(frame_, 1, 0)); };
  thread.start();
  while (!turns.is_over()) std::this_thread::yield();

  const auto finished = thread.take_finished();
  ASSERT_EQ(finished.size(), 1U);
  EXPECT_EQ(finished[0].incomplete, "the disk is nearly full");
}

TEST_F(RecordThreadTest, Lag_GrowsUntilWhatWasTakenIsOnTheDisk) {
  core::VirtualClock clock(5'000'000'000);
  Line line(64, *pipeline_);
  RecordThread thread(clock, storage_);
  thread.add("floor", line.tap);
  EXPECT_EQ(thread.view("floor").lag_s, 0.0);
  begin(thread, "floor", line);
  clock.advance_ns(700'000'000);
  EXPECT_DOUBLE_EQ(thread.view("floor").lag_s, 0.7);
  thread.mark_incomplete("floor", "as marked");
  thread.post("floor", test::event_of("marker {}"));
  line.write(at(frame_, 1, 0));
  line.close();
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

TEST_F(RecordThreadTest, EventsThatFoundNoRoom_MakeTheRecordingIncomplete) {
  Line line(256, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  core::FrameEvents triggers;
  for (int trigger = 0; trigger < 16; ++trigger) triggers.triggers.push({.segment = 1});
  for (std::uint64_t block = 0; block < 129; ++block) line.write(at(frame_, 1, block * kBlockScans), triggers);
  line.close();
  thread.start();

  EXPECT_EQ(wait(thread).incomplete, "16 events were dropped: the queue to the recorder was full");
}

TEST_F(RecordThreadTest, RecordingWhoseFileIsRemoved_EndsAtOnce) {
  Line line(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  thread.start();
  line.write(at(frame_, 1, 0));
  std::filesystem::remove_all(sessions_directory(storage_));

  const FinishedRecording finished = wait(thread);  // nobody has ended the take

  EXPECT_FALSE(finished.is_closed);
  EXPECT_THAT(finished.incomplete, HasSubstr("was deleted or moved"));
}

TEST_F(RecordThreadTest, NameTakenMeanwhile_WhatStaysSaysThatItIsIncomplete) {
  Line line(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  line.write(at(frame_, 1, 0));
  std::filesystem::create_directory(file("floor"));
  line.close();
  thread.start();

  const FinishedRecording finished = wait(thread);

  EXPECT_FALSE(finished.is_closed);
  EXPECT_THAT(record::verify(finished.file).value().incomplete, HasSubstr("exists already"));
}

TEST_F(RecordThreadTest, RigThatNeverRests_LeavesTheOthersTheirTurn) {
  Line busy(512, *pipeline_);
  Line calm(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("busy", busy.tap);
  thread.add("calm", calm.tap);
  begin(thread, "busy", busy);
  begin(thread, "calm", calm);
  std::atomic<bool> is_full = false;
  std::atomic<bool> is_over = false;
  std::jthread producer([&] {
    core::Frame frame = pipeline_->make_frame();
    for (std::uint64_t first = 0; !is_over; first += kBlockScans) {
      while (busy.tap.is_full() && !is_over) {
        is_full = true;
        std::this_thread::yield();
      }
      busy.write(at(frame, 1, first));
    }
  });
  while (!is_full) std::this_thread::yield();
  thread.start();
  calm.write(at(frame_, 1, 0));
  calm.close();

  EXPECT_EQ(wait(thread).rig, "calm");

  thread.stop();  // also ends while that rig goes on
  is_over = true;
}

TEST_F(RecordThreadTest, RecordingEndedByTheDaemon_HoldsWhatWasStillBuffered) {
  Line line(64, *pipeline_);
  RecordThread thread(clock_, storage_);
  thread.add("floor", line.tap);
  begin(thread, "floor", line);
  line.write(at(frame_, 1, 0));
  thread.start();
  thread.stop();

  const FinishedRecording finished = wait(thread);

  EXPECT_TRUE(finished.is_closed);
  EXPECT_EQ(finished.scans, kBlockScans);
  EXPECT_THAT(finished.incomplete, HasSubstr("daemon stopped"));
}

}  // namespace
}  // namespace dts::session
