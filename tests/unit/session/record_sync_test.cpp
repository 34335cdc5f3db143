// SPDX-License-Identifier: Apache-2.0
#include "session/record_sync.h"

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace dts::session {
namespace {

class RecordSyncTest : public ::testing::Test {
 protected:
  RecordSyncTest() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-sync-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    for (const char* suffix : {".part", ".idx"}) std::ofstream(recording() + suffix) << "something";
    sync_.start();
  }
  ~RecordSyncTest() override {
    sync_.stop();
    std::filesystem::remove_all(folder_);
  }
  [[nodiscard]] std::string recording() const { return (folder_ / "floor").string(); }
  static bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!condition() && std::chrono::steady_clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    return condition();
  }

  std::filesystem::path folder_;
  RecordSync sync_;
};

TEST_F(RecordSyncTest, WhatIsDone_IsTheInstantThatWasAskedFor) {
  ASSERT_TRUE(sync_.add("floor", recording()));
  EXPECT_EQ(sync_.done_ns("floor"), 0);

  ASSERT_TRUE(sync_.request("floor", 1000));
  EXPECT_TRUE(eventually([&] { return sync_.done_ns("floor") == 1000; }));
  ASSERT_TRUE(sync_.request("floor", 2500));

  EXPECT_TRUE(eventually([&] { return sync_.done_ns("floor") == 2500; }));
}

TEST_F(RecordSyncTest, ARigThatIsNotLookedAfter_HasNothingDone) {
  ASSERT_TRUE(sync_.add("floor", recording()));
  ASSERT_TRUE(sync_.request("floor", 1000));
  ASSERT_TRUE(eventually([&] { return sync_.done_ns("floor") == 1000; }));

  sync_.remove("floor");

  EXPECT_EQ(sync_.done_ns("floor"), 0);
  EXPECT_EQ(sync_.done_ns("chair"), 0);
  EXPECT_FALSE(sync_.request("floor", 2000));
}

}  // namespace
}  // namespace dts::session
