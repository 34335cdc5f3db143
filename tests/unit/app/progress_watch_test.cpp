// SPDX-License-Identifier: Apache-2.0
#include "app/progress_watch.h"

#include <gtest/gtest.h>

#include "files/rig_file.h"

namespace dts::app {
namespace {

constexpr std::int64_t kStepNs = 1'000'000'000;
constexpr std::int64_t kPatienceNs = 4 * kStepNs;

/// A rig that never starts; what it reports is made up.
class ProgressWatchTest : public ::testing::Test {
 protected:
  ProgressWatchTest() {
    files::Problems problems;
    pipeline::RigConfig config = files::read_rig_file(DTS_SOURCE_DIR "/config/rigs/floor-sim.toml", problems);
    config.name = "floor";
    config.device_uri = "sim:floor?seed=7";
    rig_ = session::Rig::create(config, clock_, bell_).value();
    config.name = "chair";
    other_rig_ = session::Rig::create(config, clock_, bell_).value();
    state_.emplace_back(session::RigState{.rig = *rig_});
    rig().acquisition.device = device::DeviceState::Streaming;
  }
  session::RigState& rig() { return state_.front(); }
  /// Behind the other one.
  void add_hung_rig() {
    state_.emplace_back(session::RigState{.rig = *other_rig_});
    state_.back().acquisition.device = device::DeviceState::Closed;
  }
  void acquire(std::uint64_t scans) {
    rig().acquisition.scans_total += scans;
    rig().acquisition.next_scan += scans;
  }
  void process() {
    rig().pipeline.end.segment = rig().acquisition.segment;
    rig().pipeline.next_scan.value = rig().acquisition.next_scan;
  }
  /// What is stuck after `seconds` of `step` each second.
  template <class Step>
  std::string after(int seconds, Step step) {
    std::string stuck;
    for (int second = 0; second < seconds; ++second) {
      step();
      stuck = watch_.stuck_part(state_, turns_, now_ns_ += kStepNs);
    }
    return stuck;
  }

  core::VirtualClock clock_;
  core::Doorbell bell_;
  std::unique_ptr<session::Rig> rig_;
  std::unique_ptr<session::Rig> other_rig_;
  std::vector<session::RigState> state_;
  std::uint64_t turns_ = 0;
  std::int64_t now_ns_ = 0;
  ProgressWatch watch_{kPatienceNs};
};

TEST_F(ProgressWatchTest, WhatMoves_IsNotStuck) {
  EXPECT_EQ(after(100, [&] { acquire(100), process(), ++turns_; }), "");
}

TEST_F(ProgressWatchTest, AFrozenPipeline_IsNamed_AndForgivenWhenItGoesOn) {
  RecordProperty("requirement", "CFG-5");
  ASSERT_EQ(after(3, [&] { acquire(100), process(), ++turns_; }), "");
  EXPECT_EQ(after(4, [&] { acquire(100), ++turns_; }), "");
  EXPECT_EQ(after(1, [&] { acquire(100), ++turns_; }), "a stage of rig 'floor'");
  EXPECT_EQ(after(1, [&] { acquire(100), process(), ++turns_; }), "");
}

TEST_F(ProgressWatchTest, AFrozenAcquireThread_IsNamed) {
  RecordProperty("requirement", "CFG-5");
  ASSERT_EQ(after(3, [&] { acquire(100), process(), ++turns_; }), "");
  EXPECT_EQ(after(5, [&] { ++turns_; }), "the device of rig 'floor'");
}

TEST_F(ProgressWatchTest, AReplayThatWaitsForTheRecorder_IsNotStuck) {
  ASSERT_EQ(after(3, [&] { acquire(100), process(), ++turns_; }), "");
  EXPECT_EQ(after(100, [&] { ++rig().acquisition.turns, ++turns_; }), "");
}

TEST_F(ProgressWatchTest, AFrozenPublishThread_IsNamed) {
  EXPECT_EQ(after(6, [&] { acquire(100), process(); }), "the publish thread");
}

TEST_F(ProgressWatchTest, ADeviceThatIsAwaySilentOrArmed_IsNoReason) {
  rig().acquisition.device = device::DeviceState::Gone;
  const auto live = [&] { ++rig().acquisition.turns, ++turns_; };
  EXPECT_EQ(after(100, live), "");
  rig().acquisition.device = device::DeviceState::Streaming;
  rig().acquisition.is_silent = true;
  EXPECT_EQ(after(100, live), "");
  rig().acquisition.is_silent = false;
  rig().acquisition.is_armed = true;
  EXPECT_EQ(after(100, live), "");
}

TEST_F(ProgressWatchTest, AnAcquireThreadThatHangsWhileItOpensItsDevice_IsNamedAfterAMinute) {
  rig().acquisition.device = device::DeviceState::Closed;
  EXPECT_EQ(after(100, [&] { ++rig().acquisition.turns, ++turns_; }), "") << "absent, and tried again and again";
  EXPECT_EQ(after(60, [&] { ++turns_; }), "");
  EXPECT_EQ(after(1, [&] { ++turns_; }), "the device of rig 'floor', which is being opened,");
}

TEST_F(ProgressWatchTest, AnAcquireThreadThatHangsDuringAnotherRigsSession_IsSaidOnceAndEndsNoSession) {
  add_hung_rig();
  rig().session.state = session::SessionState::Running;
  std::vector<std::string> said;
  const auto live = [&] {
    said.insert(said.end(), watch_.new_hangs().begin(), watch_.new_hangs().end());
    acquire(100), process(), ++turns_;
  };
  EXPECT_EQ(after(100, live), "");
  ASSERT_EQ(said.size(), 1U);
  EXPECT_TRUE(said.front().starts_with("rig 'chair': opening the device has not finished")) << said.front();

  rig().session.state = session::SessionState::Idle;
  EXPECT_EQ(after(1, live), "the device of rig 'chair', which is being opened,");
  ++state_.back().acquisition.turns;
  EXPECT_EQ(after(1, live), "");
  EXPECT_EQ(after(62, live), "the device of rig 'chair', which is being opened,");
  EXPECT_EQ(said.size(), 2U) << "it hangs again";
}

TEST_F(ProgressWatchTest, AnAcquireThreadThatHangsWhileAnotherRigStreamsForNobody_IsStuck) {
  add_hung_rig();
  EXPECT_EQ(after(62, [&] { acquire(100), process(), ++turns_; }), "the device of rig 'chair', which is being opened,");
}

TEST_F(ProgressWatchTest, SessionsOfHungRigs_ProtectNothing) {
  add_hung_rig();
  state_.back().session.state = session::SessionState::Running;
  EXPECT_EQ(after(62, [&] { acquire(100), process(), ++turns_; }), "the device of rig 'chair', which is being opened,");
}

TEST_F(ProgressWatchTest, NothingToDo_IsNotStuck) {
  ASSERT_EQ(after(1, [&] { acquire(100), process(), ++turns_; }), "");
  rig().acquisition.is_silent = true;
  EXPECT_EQ(after(20, [&] { ++turns_; }), "");
}

}  // namespace
}  // namespace dts::app
