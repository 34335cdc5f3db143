// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/doorbell.h"
#include "core/worker.h"
#include "floor_config.h"
#include "hand_fed.h"
#include "session/recordings.h"
#include "session/supervisor.h"

namespace dts::session {

/// A rig with its real threads on a device that the test feeds, with its recordings, catalogue and recovery, in a folder of its own.
class RecordingsTest : public testing::Test {
 protected:
  static constexpr std::size_t kBlock = 15;  ///< 10 ms.

  RecordingsTest() {
    const bool has_memory = ::access("/dev/shm", W_OK) == 0;  // nothing here needs to outlive the machine
    const auto parent = has_memory ? std::filesystem::path("/dev/shm") : std::filesystem::temp_directory_path();
    std::string name = (parent / "dts-recordings-XXXXXX").string();
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
    recordings_ = Recordings::open(storage_, clock_, log_).value();
    supervisor_ = std::make_unique<Supervisor>(clock_, log_, nullptr,
                                               SessionServices{.recordings = *recordings_,
                                                               .worker = worker_,
                                                               .protocols = std::move(protocols),
                                                               .label_rule = label_rule_,
                                                               .software = "dtsd test",
                                                               .boot_id = "boot 1"});
    auto device = std::make_unique<HandFedDevice>(config_.sensor_channels.size());
    device_ = device.get();
    ASSERT_TRUE(supervisor_->add(Rig::create(config_, std::move(device), clock_, bell_).value()));
    is_running_ = false;
  }
  void run() {
    supervisor_->start();
    is_running_ = true;
  }
  void start(std::vector<Protocol> protocols = {Protocol{}}) {
    open(std::move(protocols));
    run();
    feed(kBlock);
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

  /// The next scans come, each at its time, and are processed. Whole blocks.
  void feed(std::size_t scans) {
    for (std::size_t fed = 0; fed < scans; fed += kBlock) {
      const std::uint64_t before = rig().acquisition().scans_total;
      device_->give({.scans = kBlock, .host_ns = clock_.now_ns()});
      clock_.advance_s(0.01);
      while (rig().acquisition().scans_total == before || !is_processed() || is_recorder_behind()) std::this_thread::yield();
    }
  }
  [[nodiscard]] bool is_processed() {
    const PipelineReport& done = rig().pipeline_report();
    return done.end.segment == rig().acquisition().segment && done.next_scan.value == rig().acquisition().next_scan;
  }
  /// Hand-fed seconds pass faster than real ones: the recorder must not lose scans because this machine is slow.
  [[nodiscard]] bool is_recorder_behind() { return rig().tap().waiting() > rig().tap().capacity() / 2; }
  [[nodiscard]] Rig& rig() { return *supervisor_->rigs().at(0); }

  /// The daemon goes on, with a new block of scans at each turn.
  [[nodiscard]] bool eventually(const std::function<bool()>& condition) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (std::chrono::steady_clock::now() < deadline) {
      supervisor_->tick();
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (is_running_) feed(kBlock);
    }
    return false;
  }
  [[nodiscard]] SessionState state() { return supervisor_->states().at(0).session.state; }
  [[nodiscard]] bool is_in(SessionState wanted) {
    return eventually([&] { return state() == wanted; });
  }
  [[nodiscard]] bool is_recovered(const std::string& id) {
    return eventually([&] { return row(id).parts.at(0).state == record::PartState::Recovered; });
  }
  /// Starts a session and records `scans`.
  [[nodiscard]] std::string record(std::size_t scans, const SessionRequest& request = {}) {
    const auto started = supervisor_->start_session("floor", request);
    EXPECT_TRUE(started) << started.error().what;
    feed(kBlock);
    EXPECT_TRUE(eventually([&] { return state() != SessionState::Starting; }));
    feed(scans);
    return started->id;
  }
  /// Stops the session and waits for the end of its recording.
  [[nodiscard]] bool stop(bool is_abort = false, const std::string& reason = {}) {
    const auto stopped = supervisor_->stop_session("floor", is_abort, reason);
    EXPECT_TRUE(stopped) << stopped.error().what;
    return stopped && is_in(SessionState::Idle);
  }
  [[nodiscard]] record::SessionRow row(const std::string& id) { return recordings_->catalogue().session(id).value(); }

  std::filesystem::path folder_;
  StorageConfig storage_;
  LabelRule label_rule_;
  pipeline::RigConfig config_ = floor_config("hand:fed", kBlock);
  HandClock clock_;
  core::Doorbell bell_;
  std::ostringstream said_;
  core::Log log_{std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(said_))};
  core::Worker worker_{"analyse"};
  std::unique_ptr<Recordings> recordings_;
  std::unique_ptr<Supervisor> supervisor_;
  HandFedDevice* device_ = nullptr;  ///< The rig's.
  bool is_running_ = false;
};

}  // namespace dts::session
