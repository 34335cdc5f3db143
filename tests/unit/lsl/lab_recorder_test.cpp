// SPDX-License-Identifier: Apache-2.0
#include "lsl/lab_recorder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "support/fake_lab_recorder.h"

namespace dts::lsl {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Polls for at most 30 s.
bool comes_true(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition() && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return condition();
}

class LabRecorderTest : public ::testing::Test {
 protected:
  LabRecorderSettings settings() { return {.host = "127.0.0.1", .port = static_cast<std::uint16_t>(fake_.port()), .folder = {}}; }
  bool has_lines(std::size_t count) {
    return comes_true([this, count] { return fake_.lines().size() >= count; });
  }

  /// Returns how many log lines have the text.
  std::ptrdiff_t logged(const std::string& text) {
    return std::ranges::count_if(sink_->last_formatted(),
                                 [&text](const std::string& line) { return line.find(text) != std::string::npos; });
  }

  test::FakeLabRecorder fake_;
  std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> sink_ = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(100);
  core::Log log_{std::make_shared<spdlog::logger>("test", sink_)};
};

TEST_F(LabRecorderTest, NextSession_GetsAFileOfItsOwn) {
  LabRecorder recorder(settings(), log_);
  recorder.follow("a");
  ASSERT_TRUE(has_lines(3));
  recorder.follow("b");
  ASSERT_TRUE(has_lines(7));
  recorder.follow("");
  ASSERT_TRUE(has_lines(8));
  EXPECT_THAT(fake_.lines(), ElementsAre("update", "filename {template:dtsd_a.xdf}", "start", "stop", "update",
                                         "filename {template:dtsd_b.xdf}", "start", "stop"));
}

TEST_F(LabRecorderTest, Destructor_StopsTheFileUnderWay) {
  {
    LabRecorder recorder(settings(), log_);
    recorder.follow("a");
    ASSERT_TRUE(has_lines(3));
  }
  EXPECT_EQ(fake_.lines().back(), "stop");
}

TEST_F(LabRecorderTest, SessionThatEndsBeforeStartIsConfirmed_IsStopped) {
  LabRecorder recorder(settings(), log_);
  recorder.follow("a");
  ASSERT_TRUE(has_lines(3));
  fake_.fall_silent();
  recorder.follow("");
  ASSERT_TRUE(has_lines(4));
  EXPECT_THAT(fake_.lines(), ElementsAre("update", "filename {template:dtsd_a.xdf}", "start", "stop"));
}

TEST_F(LabRecorderTest, WithoutASession_SaysNothing) {
  { LabRecorder recorder(settings(), log_); }
  EXPECT_THAT(fake_.lines(), IsEmpty());
}

TEST_F(LabRecorderTest, SilentLabRecorder_IsReportedOnceAndNotStarted) {
  fake_.fall_silent();
  {
    LabRecorder recorder(settings(), log_);
    recorder.follow("a");
    ASSERT_TRUE(has_lines(2));  // it is asked again
  }
  EXPECT_THAT(fake_.lines(), testing::Each(testing::Eq("update")));
  EXPECT_EQ(logged("LabRecorder did not confirm the command 'update'"), 1);
}

TEST_F(LabRecorderTest, ConnectionThatEnds_IsReportedWithTheCommandAndWhatToDo) {
  fake_.hang_up();
  LabRecorder recorder(settings(), log_);
  recorder.follow("a");
  EXPECT_TRUE(comes_true([this] {
    return logged(
               "LabRecorder ended the connection after the command 'update' (start LabRecorder, and tick RCS in its window (the port "
               "is beside it)); dts-lsl retries every 5 s") == 1;
  }));
}

TEST_F(LabRecorderTest, AbsentLabRecorder_IsReported) {
  LabRecorderSettings nowhere = settings();
  {
    test::FakeLabRecorder gone;
    nowhere.port = static_cast<std::uint16_t>(gone.port());
  }
  LabRecorder recorder(nowhere, log_);
  recorder.follow("a");
  EXPECT_TRUE(comes_true([this] { return logged("LabRecorder does not answer at 127.0.0.1:") == 1; }));
}

}  // namespace
}  // namespace dts::lsl
