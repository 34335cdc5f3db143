// SPDX-License-Identifier: Apache-2.0
#include "lsl/marker_inlets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <set>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace dts::lsl {
namespace {

TEST(MarkerRequest, SameMarker_HasTheSameId) {
  const ReceivedMarker marker{
      .stream_uid = "1f0c7a52-6e1d-4b7e-9a63-0a3c5d7e9b11", .stream_name = "Task", .text = "go", .sender_time_s = 12.5};
  ReceivedMarker again = marker;
  again.host_time_ns = 1;  // the estimate of the other clock may differ
  EXPECT_EQ(request_id(marker), request_id(again));
  again.stream_uid += "longer than LSL's";
  EXPECT_EQ(request_id(marker), request_id(again));
  EXPECT_EQ(request_id(marker).size(), 64U) << "dtsd accepts no longer one";
}

TEST(MarkerRequest, OtherStreamTimeOrText_HasAnotherId) {
  const ReceivedMarker marker{
      .stream_uid = "1f0c7a52-6e1d-4b7e-9a63-0a3c5d7e9b11", .stream_name = "Task", .text = "go", .sender_time_s = 12.5};
  std::set<std::string> ids{request_id(marker)};
  ReceivedMarker other = marker;
  other.stream_uid.back() = '2';
  ids.insert(request_id(other));
  other = marker;
  other.sender_time_s += 1e-9;
  ids.insert(request_id(other));
  other = marker;
  other.text = "stop";
  ids.insert(request_id(other));
  other = marker;
  other.repeat = 1;
  ids.insert(request_id(other));
  EXPECT_EQ(ids.size(), 5U);
}

/// Another program's stream, in memory. `lsl_mutex` guards all of it.
struct FakeSender {
  std::string uid;
  std::deque<std::pair<std::string, double>> samples;
  double correction_s = 0.0;
  bool has_clock = true;
  bool has_ended = false;
  int opened = 0;
  int open = 0;
  int measured = 0;
};
std::mutex lsl_mutex;
std::vector<std::unique_ptr<FakeSender>> senders;

FakeSender& sender(void* handle) { return *static_cast<FakeSender*>(handle); }

/// A library whose functions know `senders` only. Its resolver does not forget streams that have ended.
Liblsl library_of_senders() {
  Liblsl lsl;
  lsl.create_continuous_resolver_bypred = [](const char*, double) -> api::Resolver { return &senders; };
  lsl.destroy_continuous_resolver = [](api::Resolver) {};
  lsl.resolver_results = [](api::Resolver, api::Info* found, std::uint32_t size) {
    const std::lock_guard lock(lsl_mutex);
    const std::size_t count = std::min<std::size_t>(size, senders.size());
    for (std::size_t index = 0; index < count; ++index) found[index] = senders[index].get();
    return static_cast<std::int32_t>(count);
  };
  lsl.destroy_streaminfo = [](api::Info) {};
  lsl.get_uid = [](api::Info info) { return sender(info).uid.c_str(); };
  lsl.get_name = [](api::Info) { return "Task"; };
  lsl.get_source_id = [](api::Info) { return "task"; };
  lsl.get_nominal_srate = [](api::Info) { return api::kIrregularRate; };
  lsl.get_channel_count = [](api::Info) { return std::int32_t{1}; };
  lsl.create_inlet = [](api::Info info, std::int32_t, std::int32_t, std::int32_t) -> api::Inlet {
    const std::lock_guard lock(lsl_mutex);
    ++sender(info).opened;
    ++sender(info).open;
    return info;
  };
  lsl.destroy_inlet = [](api::Inlet inlet) {
    const std::lock_guard lock(lsl_mutex);
    --sender(inlet).open;
  };
  lsl.pull_sample_str = [](api::Inlet inlet, char** texts, std::int32_t, double, std::int32_t* error) {
    const std::lock_guard lock(lsl_mutex);
    FakeSender& from = sender(inlet);
    *error = from.has_ended ? api::kLostError : api::kNoError;
    if (from.has_ended || from.samples.empty()) return 0.0;
    const auto [text, stamp_s] = from.samples.front();
    from.samples.pop_front();
    texts[0] = ::strdup(text.c_str());
    return stamp_s;
  };
  lsl.destroy_string = [](char* text) { std::free(text); };
  lsl.time_correction = [](api::Inlet inlet, double, std::int32_t* error) {
    const std::lock_guard lock(lsl_mutex);
    ++sender(inlet).measured;
    *error = sender(inlet).has_clock ? api::kNoError : -1;
    return sender(inlet).correction_s;
  };
  return lsl;
}

class MarkerInletsTest : public ::testing::Test {
 protected:
  MarkerInletsTest() { senders.clear(); }
  static FakeSender& add() {
    const std::lock_guard lock(lsl_mutex);
    senders.push_back(std::make_unique<FakeSender>(FakeSender{.uid = "uid-" + std::to_string(senders.size())}));
    return *senders.back();
  }
  static void change(const std::function<void()>& make) {
    const std::lock_guard lock(lsl_mutex);
    make();
  }
  static bool holds(const std::function<bool()>& condition) {
    const std::lock_guard lock(lsl_mutex);
    return condition();
  }
  /// Polls for at most 30 s.
  static bool becomes(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    while (!holds(condition) && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return holds(condition);
  }
  std::unique_ptr<MarkerInlets> start() {
    return MarkerInlets::start(
               functions_, {"name='Task'"},
               [this](const ReceivedMarker& marker, const std::stop_token& stop) {
                 change([&] { handled_.push_back(marker); });
                 while (is_stuck_ && !stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
               },
               log_)
        .value();
  }
  std::ptrdiff_t said(const std::string& text) {
    return std::ranges::count_if(sink_->last_formatted(),
                                 [&text](const std::string& line) { return line.find(text) != std::string::npos; });
  }

  Liblsl functions_ = library_of_senders();
  std::vector<ReceivedMarker> handled_;  // guarded by `lsl_mutex`
  std::atomic<bool> is_stuck_ = false;
  std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> sink_ = std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(100);
  core::Log log_{std::make_shared<spdlog::logger>("test", sink_)};
};

TEST_F(MarkerInletsTest, SilentDaemon_DelaysNeitherReceivingNorTheEnd) {
  FakeSender& task = add();
  task.samples = {{"a", 1.0}, {"b", 2.0}, {"c", 3.0}};
  is_stuck_ = true;
  auto inlets = start();
  ASSERT_TRUE(becomes([&] { return handled_.size() == 1; }));
  EXPECT_TRUE(becomes([&] { return task.samples.empty(); }));
  inlets.reset();  // returns although the daemon is silent
  EXPECT_EQ(handled_.size(), 1U);
}

TEST_F(MarkerInletsTest, MarkersOfAStreamThatHasEnded_AreKeptAndTheStreamIsNotOpenedAgain) {
  FakeSender& task = add();
  task.samples = {{"a", 1.0}, {"b", 2.0}, {"c", 3.0}};
  is_stuck_ = true;
  auto inlets = start();
  ASSERT_TRUE(becomes([&] { return task.samples.empty(); }));
  change([&] { task.has_ended = true; });
  ASSERT_TRUE(becomes([&] { return said("has ended") == 1; }));
  is_stuck_ = false;
  EXPECT_TRUE(becomes([&] { return handled_.size() == 3; }));
  FakeSender& next = add();
  ASSERT_TRUE(becomes([&] { return next.opened == 1; }));
  EXPECT_TRUE(holds([&] { return task.opened == 1 && task.open == 0 && next.open == 1; }));
  inlets.reset();
  EXPECT_EQ(next.open, 0);
}

TEST_F(MarkerInletsTest, ClockThatDrifts_IsMeasuredAgain) {
  FakeSender& task = add();
  task.correction_s = 10.0;
  task.samples = {{"a", 1.0}};
  const auto begin = std::chrono::steady_clock::now();
  const auto inlets = start();
  ASSERT_TRUE(becomes([&] { return handled_.size() == 1; }));
  EXPECT_TRUE(holds([&] { return handled_[0].host_time_ns == 11'000'000'000; }));
  change([&] { task.correction_s = 10.5; });
  EXPECT_TRUE(becomes([&] {
    if (task.samples.empty()) task.samples.emplace_back("b", 1.0);
    return handled_.back().host_time_ns == 11'500'000'000;
  }));
  EXPECT_TRUE(holds([&] { return task.measured <= 1 + (std::chrono::steady_clock::now() - begin) / std::chrono::seconds(2); }))
      << "every 2 s";
}

TEST_F(MarkerInletsTest, StreamWithoutAClock_WaitsAndDelaysNoOtherStream) {
  FakeSender& dead = add();
  dead.has_clock = false;
  dead.samples = {{"late", 1.0}};
  FakeSender& task = add();
  task.samples = {{"go", 2.0}};
  const auto inlets = start();
  ASSERT_TRUE(becomes([&] { return handled_.size() == 1; }));
  EXPECT_TRUE(holds([&] { return handled_[0].text == "go"; }));
  change([&] { dead.has_clock = true; });
  ASSERT_TRUE(becomes([&] { return handled_.size() == 2; }));
  EXPECT_TRUE(holds([&] { return handled_[1].text == "late" && handled_[1].host_time_ns == 1'000'000'000; }));
}

TEST_F(MarkerInletsTest, EqualMarkersOfOneChunk_AreDifferentMarkers) {
  add().samples = {{"a", 1.0}, {"a", 1.0}, {"a", 1.0}, {"b", std::numeric_limits<double>::quiet_NaN()}, {"c", 2.0}};
  const auto inlets = start();
  ASSERT_TRUE(becomes([&] { return handled_.size() == 4; }));
  std::set<std::string> ids;
  for (const ReceivedMarker& marker : handled_) ids.insert(request_id(marker));
  EXPECT_EQ(ids.size(), 4U);
  EXPECT_EQ(said("its time is no number"), 1);
}

TEST_F(MarkerInletsTest, FloodOfMarkers_IsLimitedTo50PerSecond) {
  FakeSender& task = add();
  for (int number = 0; number < 300; ++number) task.samples.emplace_back("a", 1.0);
  const auto begin = std::chrono::steady_clock::now();
  const auto inlets = start();
  ASSERT_TRUE(becomes([&] { return task.samples.empty(); }));
  const double passed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  FakeSender& other = add();
  change([&] { other.samples = {{"end", 1.0}}; });
  ASSERT_TRUE(becomes([&] { return !handled_.empty() && handled_.back().text == "end"; }));
  EXPECT_GE(handled_.size(), 201U) << "four seconds' worth at once, and the marker of the other stream";
  EXPECT_LE(static_cast<double>(handled_.size()), 202.0 + 50.0 * passed_s);
  if (passed_s < 1.0) {  // a slower machine leaves time for more markers
    EXPECT_GE(said("sends more than 50 markers per second"), 5);
  }
  EXPECT_LT(said("sends more than 50 markers per second"), 20) << "the log is limited, too";
}

TEST_F(MarkerInletsTest, OneStreamTooMany_IsReportedAndOpenedLater) {
  for (int count = 0; count < 33; ++count) add();
  FakeSender& last = *senders.back();
  const auto inlets = start();
  ASSERT_TRUE(becomes([&] { return said("receives from at most 32 marker streams") == 1; }));
  EXPECT_TRUE(holds([&] { return last.opened == 0; }));
  change([&] { senders.front()->has_ended = true; });
  EXPECT_TRUE(becomes([&] { return last.opened == 1; }));
}

}  // namespace
}  // namespace dts::lsl
