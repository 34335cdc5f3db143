// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/doorbell.h"
#include "floor_config.h"
#include "session/recordings.h"
#include "session/supervisor.h"

namespace dts::session {

/// A real rig (simulated floor, real threads) with its recordings, catalogue and recovery, in a folder of its own.
class RecordingsTest : public testing::Test {
 protected:
  RecordingsTest() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-recordings-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    storage_ = {.directory = folder_.string(), .refuse_below_min = 0.0, .warn_below_min = 0.0, .stop_below_mib = 0.0};
  }
  ~RecordingsTest() override {
    supervisor_.reset();
    recordings_.reset();
    std::filesystem::remove_all(folder_);
  }

  /// The daemon's session part on the test's folder; its threads do not run yet.
  void open(std::vector<Protocol> protocols = {Protocol{}}) {
    recordings_ = Recordings::open(storage_, clock_, core::Log()).value();
    supervisor_ = std::make_unique<Supervisor>(
        clock_, core::Log(), nullptr,
        SessionServices{.recordings = recordings_.get(), .protocols = std::move(protocols), .software = "test"});
    ASSERT_TRUE(supervisor_->add(Rig::create(floor_config("sim:floor?seed=3&step_on_s=0.2", 15), clock_, bell_).value()));
  }
  void start(std::vector<Protocol> protocols = {Protocol{}}) {
    open(std::move(protocols));
    supervisor_->start();
    ASSERT_TRUE(eventually([&] { return supervisor_->states().at(0).acquisition.scans_total > 0; }));
  }
  void end() {
    supervisor_->stop();
    supervisor_.reset();
    recordings_.reset();
  }

  /// What a killed daemon leaves: the files as they are now.
  void leave() {
    const std::filesystem::path left = folder_.string() + "-left";
    std::filesystem::copy(folder_, left, std::filesystem::copy_options::recursive);
    end();
    std::filesystem::remove_all(folder_);
    std::filesystem::rename(left, folder_);
  }

  [[nodiscard]] bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      if (supervisor_) supervisor_->tick();
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }
  [[nodiscard]] bool is_in(SessionState state) {
    return eventually([&] { return supervisor_->states().at(0).session.state == state; });
  }
  /// Starts a session and waits until it has recorded `scans`.
  [[nodiscard]] std::string record(std::uint64_t scans, const SessionRequest& request = {}) {
    const auto started = supervisor_->start_session("floor", request);
    EXPECT_TRUE(started) << started.error().what;
    const std::uint64_t before = supervisor_->states().at(0).acquisition.scans_total;
    EXPECT_TRUE(eventually([&] { return supervisor_->states().at(0).acquisition.scans_total > before + scans; }));
    return started->id;
  }
  [[nodiscard]] record::SessionRow row(const std::string& id) { return recordings_->catalogue().session(id).value(); }

  std::filesystem::path folder_;
  StorageConfig storage_;
  /// The machine's, whose wall clock can be set.
  class SettableClock : public core::Clock {
   public:
    [[nodiscard]] std::int64_t now_ns() const noexcept override { return system_.now_ns(); }
    void sleep_until_ns(std::int64_t deadline_ns) noexcept override { system_.sleep_until_ns(deadline_ns); }
    [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return Clock::utc_minus_monotonic_ns() + set_by_ns; }
    std::atomic<std::int64_t> set_by_ns{0};

   private:
    core::SystemClock system_;
  };
  SettableClock clock_;
  core::Doorbell bell_;
  std::unique_ptr<Recordings> recordings_;
  std::unique_ptr<Supervisor> supervisor_;
};

}  // namespace dts::session
