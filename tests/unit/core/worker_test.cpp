// SPDX-License-Identifier: Apache-2.0
#include "core/worker.h"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

namespace dts::core {
namespace {

TEST(Worker, Jobs_RunInTheirOrderOnAnotherThread) {
  Worker worker("test");
  std::vector<int> done;
  std::vector<std::future<std::thread::id>> jobs;
  for (int job = 0; job < 100; ++job) {
    jobs.push_back(worker.run([&done, job] {
      done.push_back(job);
      return std::this_thread::get_id();
    }));
  }
  const std::thread::id used = jobs.back().get();
  EXPECT_NE(used, std::this_thread::get_id());
  for (int job = 0; job < 100; ++job) EXPECT_EQ(done.at(static_cast<std::size_t>(job)), job);
  for (std::size_t job = 0; job + 1 < jobs.size(); ++job) {
    EXPECT_TRUE(is_ready(jobs[job]));
    EXPECT_EQ(jobs[job].get(), used);
  }
}

TEST(Worker, EndOfTheWorker_WaitsForTheJobThatRuns) {
  std::promise<void> has_begun;
  std::promise<void> go_on;
  std::atomic<bool> is_done = false;
  std::optional<Worker> worker("test");
  const auto job = worker->run([&] {
    has_begun.set_value();
    go_on.get_future().wait();
    is_done = true;
  });
  has_begun.get_future().wait();
  EXPECT_FALSE(is_ready(job));
  const std::jthread later([&] { go_on.set_value(); });
  worker.reset();
  EXPECT_TRUE(is_done);
}

TEST(Worker, JobThatCannotBeCopied_Runs) {
  Worker worker("test");
  auto number = std::make_unique<int>(7);
  EXPECT_EQ(worker.run([number = std::move(number)] { return *number; }).get(), 7);
}

}  // namespace
}  // namespace dts::core
