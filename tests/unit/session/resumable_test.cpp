// SPDX-License-Identifier: Apache-2.0
// Which sessions a daemon goes on with after a crash, and when.
#include <gmock/gmock.h>

#include "recordings_fixture.h"

namespace dts::session {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class ResumableTest : public RecordingsTest {
 protected:
  ResumableTest() { storage_.resume_within_min = 10.0; }

  /// What a daemon that starts now would go on with; it ends before it does.
  [[nodiscard]] std::vector<std::string> resumable() { return Recordings::open(storage_, clock_, core::Log()).value()->take_resumable(); }
  /// A session that was cut off `parts` times, each of them a moment after it began.
  [[nodiscard]] std::string cut_off(int parts) {
    start();
    const std::string id = record(50);
    leave_now();
    for (int part = 2; part <= parts; ++part) {
      start();
      EXPECT_TRUE(supervisor_->resume_session(id));
      EXPECT_TRUE(is_in(SessionState::Running));
      leave_now();
    }
    return id;
  }

 private:
  /// The files were last written at the time of the test: on a slow machine, a part of a moment may take a minute.
  void leave_now() {
    leave();
    const std::chrono::sys_time<std::chrono::nanoseconds> now(std::chrono::nanoseconds(clock_.now_ns() + clock_.utc_minus_monotonic_ns()));
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "sessions")) {
      if (entry.path().extension() == ".part") std::filesystem::last_write_time(entry.path(), std::chrono::file_clock::from_sys(now));
    }
  }
};

TEST_F(ResumableTest, SessionThatACrashEnded_GoesOn_AlsoAfterASecondCrashBeforeItCould) {
  const std::string id = cut_off(1);

  EXPECT_THAT(resumable(), ElementsAre(id));
  EXPECT_THAT(resumable(), ElementsAre(id));
}

TEST_F(ResumableTest, SessionBeforeTheLastOfItsRig_DoesNot) {
  static_cast<void>(cut_off(1));
  start();
  static_cast<void>(record(50));
  end();

  EXPECT_THAT(resumable(), IsEmpty());
}

TEST_F(ResumableTest, SessionLongAgo_DoesNot) {
  const std::string id = cut_off(1);
  std::filesystem::last_write_time(folder_ / "sessions" / (id + ".xdf.part"),
                                   std::filesystem::file_time_type::clock::now() - std::chrono::minutes(11));

  EXPECT_THAT(resumable(), IsEmpty());
}

TEST_F(ResumableTest, ThreeShortPartsInARow_AreEnough_ButNotWhenTheLastOneWasLong) {
  const std::string id = cut_off(3);
  EXPECT_THAT(resumable(), IsEmpty());

  std::filesystem::last_write_time(
      std::filesystem::path(Recordings::open(storage_, clock_, core::Log()).value()->catalogue().session(id)->parts.back().file),
      std::filesystem::file_time_type::clock::now() + std::chrono::minutes(2));
  EXPECT_THAT(resumable(), ElementsAre(id));
}

TEST_F(ResumableTest, RigThatHasNotDeliveredYet_IsWaitedFor) {
  const std::string id = cut_off(1);
  open();
  supervisor_->resume_interrupted();

  supervisor_->tick();
  EXPECT_EQ(state(), SessionState::Idle);
  run();

  ASSERT_TRUE(is_in(SessionState::Running));
  EXPECT_EQ(supervisor_->states().at(0).session.id, id);
  EXPECT_EQ(row(id).parts.size(), 2U);
  const auto newest = recordings_->catalogue().audit(1).value().at(0);
  EXPECT_EQ(newest.who + " " + newest.what + " " + newest.target + " " + newest.result, "dtsd resume_session " + id + " ok");
  EXPECT_NEAR(static_cast<double>(newest.utc_ns - clock_.now_ns() - clock_.utc_minus_monotonic_ns()), 0.0, 60e9);
  EXPECT_THAT(said_.str(), testing::HasSubstr("session " + id + " was interrupted; dtsd resumed it"));
}

TEST_F(ResumableTest, DeviceThatStaysAway_IsWaitedForAMinute_WithATryEverySecond) {
  const std::string id = cut_off(1);
  open();
  device_->is_absent = true;
  supervisor_->start();
  while (rig().acquisition().text().empty()) std::this_thread::yield();
  supervisor_->resume_interrupted();
  const auto given_up = [&] {
    return said_.str().find("session " + id + " was interrupted, and dtsd cannot resume it: ") != std::string::npos;
  };

  for (int second = 0; second < 60; ++second) {
    supervisor_->tick();
    EXPECT_FALSE(given_up()) << second;
    clock_.advance_s(1.0);
  }
  supervisor_->tick();

  EXPECT_TRUE(given_up());
  EXPECT_EQ(row(id).parts.size(), 1U);
}

TEST_F(ResumableTest, DeviceThatReturnsAfterItDelivered_IsTriedAgainASecondLater) {
  const std::string id = cut_off(1);
  start();
  device_->is_absent = true;
  device_->give({.outcome = device::ReadOutcome::Gone});
  while (rig().acquisition().text().find("not plugged in") == std::string_view::npos) std::this_thread::yield();
  supervisor_->resume_interrupted();
  supervisor_->tick();
  device_->is_absent = false;
  clock_.advance_s(0.9);
  while (rig().acquisition().device != device::DeviceState::Streaming) {
    std::this_thread::yield();
    supervisor_->tick();
    ASSERT_EQ(state(), SessionState::Idle) << "not yet";
  }
  supervisor_->tick();
  EXPECT_EQ(state(), SessionState::Idle) << "a second between two tries";
  clock_.advance_s(0.1);
  supervisor_->tick();
  EXPECT_EQ(state(), SessionState::Starting);
  EXPECT_EQ(supervisor_->states().at(0).session.id, id);
}

}  // namespace
}  // namespace dts::session
