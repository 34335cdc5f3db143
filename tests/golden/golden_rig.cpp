// SPDX-License-Identifier: Apache-2.0
#include "golden/golden_rig.h"

#include <google/protobuf/text_format.h>
#include <poll.h>
#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <memory>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <utility>

#include "core/worker.h"
#include "golden/golden_text.h"
#include "ipc/command_handler.h"
#include "ipc/publish_thread.h"
#include "session/recordings.h"
#include "session/supervisor.h"
#include "support/test_device.h"

namespace dts::golden {
namespace {

constexpr std::uint64_t kInstance = 1;
constexpr std::int64_t kStartNs = 1'000'000'000;
constexpr std::chrono::seconds kPatience{60};
const std::string kBarrier = "barrier";  ///< As a rig

/// Virtual time with a wall clock of its own: ids of sessions are made of it, and orders of trials of these.
class GoldenClock final : public core::Clock {
 public:
  [[nodiscard]] std::int64_t now_ns() const noexcept override { return clock_.now_ns(); }
  void sleep_until_ns(std::int64_t deadline_ns) noexcept override { clock_.sleep_until_ns(deadline_ns); }
  [[nodiscard]] std::int64_t utc_minus_monotonic_ns() const noexcept override { return 1'700'000'000'000'000'000; }
  void advance_ns(std::int64_t step_ns) noexcept { clock_.advance_ns(step_ns); }

 private:
  core::VirtualClock clock_{kStartNs};
};

/// What the test thread gives to the rig's thread, one at a time.
struct Turn {
  bool is_open = false;  ///< An answer to `open`; else to `read`.
  bool succeeds = true;  ///< Of `open`.
  device::ReadResult result{};
  std::vector<std::vector<Sample>> rows{};
  std::uint64_t skipped = 0;  ///< The device's counter jumps by this before the scans.
  std::int64_t host_time_ns = 0;
};

/// A device that does nothing until the test gives it a turn, and lets the test wait until it asks for the next one.
class PlayedDevice final : public device::TestDevice {
 public:
  PlayedDevice(const std::string& uri, std::vector<device::ChannelDescription> channels) {
    description_ = {.uri = uri, .model = kRecordedModel, .serial = "1", .channels = std::move(channels)};
  }

  core::Status open() override {
    const Turn turn = next(true);
    if (!turn.succeeds) return core::fail(core::ErrorCode::NotFound, "not plugged in");
    return TestDevice::open();
  }
  device::ReadResult read(core::Block& block, std::int64_t) noexcept override {
    const Turn turn = next(false);
    if (turn.result.outcome != device::ReadOutcome::Scans) return without_scans(turn.result.outcome, turn.result.gap);
    index_ += turn.skipped;
    block.set_count(turn.rows.size());
    block.first_scan = {index_};
    block.host_time_ns = turn.host_time_ns;
    block.host_time_uncertainty_ns = 0;
    block.clock_drift_ppm = 0.0;
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      for (std::size_t scan = 0; scan < block.count(); ++scan) {
        block.column(channel)[scan] = turn.rows[scan][channel].value;
        block.quality(channel)[scan] = turn.rows[scan][channel].quality;
      }
    }
    index_ += block.count();
    return turn.result;
  }
  void interrupt() noexcept override {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
    changed_.notify_all();
  }
  /// Thread: test. Returns when the turn was taken and the rig's thread asks for the next.
  void give(Turn turn) {
    std::unique_lock lock(mutex_);
    const bool is_right = changed_.wait_for(lock, kPatience, [this] { return is_asking_; }) && turn.is_open == is_opening_;
    if (!is_right) throw std::runtime_error("the rig's thread asks for something else");
    turn_ = std::move(turn);
    has_turn_ = true;
    is_asking_ = false;
    changed_.notify_all();
    if (!changed_.wait_for(lock, kPatience, [this] { return is_asking_; })) throw std::runtime_error("the rig's thread hangs");
  }

 private:
  Turn next(bool is_open) noexcept {
    std::unique_lock lock(mutex_);
    is_asking_ = true;
    is_opening_ = is_open;
    changed_.notify_all();
    changed_.wait(lock, [this] { return has_turn_ || has_ended_; });
    if (!std::exchange(has_turn_, false)) return {.is_open = is_open, .succeeds = false, .result = {device::ReadOutcome::Timeout, {}}};
    return std::move(turn_);
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  Turn turn_;
  bool has_turn_ = false;
  bool is_asking_ = false;
  bool is_opening_ = true;
  bool has_ended_ = false;
};

/// What was sent, shared between the socket and the test.
class Sent {
 public:
  void add(std::string_view topic, const google::protobuf::MessageLite& message) {
    const std::lock_guard lock(mutex_);
    if (topic == kBarrier + "/") {
      ++barriers_;
      changed_.notify_all();
    } else {
      lines_.push_back(line_of(topic, dynamic_cast<const google::protobuf::Message&>(message)));
    }
  }
  void add_line(std::string line) {
    const std::lock_guard lock(mutex_);
    lines_.push_back(std::move(line));
  }
  void wait_for_barrier(std::uint64_t number) {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, kPatience, [&] { return barriers_ >= number; })) throw std::runtime_error("the publish thread hangs");
  }
  [[nodiscard]] std::vector<std::string> lines() {
    const std::lock_guard lock(mutex_);
    return lines_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::string> lines_;
  std::uint64_t barriers_ = 0;
};

class CollectingSocket final : public ipc::DataSocket {
 public:
  explicit CollectingSocket(Sent& sent) : sent_(sent) {}
  void send(std::string_view topic, const google::protobuf::MessageLite& message) override { sent_.add(topic, message); }
  void wait(int bell_fd, int timeout_ms) override {
    pollfd wanted{.fd = bell_fd, .events = POLLIN, .revents = 0};
    poll(&wanted, 1, timeout_ms);
  }
  bool take_subscriptions() override { return false; }

 private:
  Sent& sent_;
};

/// A folder for the recordings, which nobody reads.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-golden-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no folder for the recordings");
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

std::unique_ptr<session::Recordings> open_recordings(const std::string& folder, core::Clock& clock) {
  auto recordings = session::Recordings::open({.directory = folder, .refuse_below_min = 0.0, .warn_below_min = 0.0, .stop_below_mib = 0.0},
                                              clock, core::Log());
  if (!recordings) throw std::runtime_error(core::to_string(recordings.error()));
  return std::move(*recordings);
}

class Runner {
 public:
  Runner(const Case& golden, const Scans& scans)
      : golden_(golden),
        scans_(scans),
        supervisor_(
            clock_, core::Log(), nullptr,
            {.recordings = *recordings_, .worker = worker_, .protocols = golden.protocols, .software = "dtsd 0", .boot_id = "boot"}),
        handler_(supervisor_, clock_, {.instance_id = kInstance, .version = "0", .boot_id = "boot", .started_ns = kStartNs}, {},
                 ipc::KeyCommands(nullptr, clock_, {})) {
    auto device = std::make_unique<PlayedDevice>(golden.rig.device_uri, scans.channels);
    device_ = device.get();
    auto rig = session::Rig::create(golden.rig, std::move(device), clock_, bell_);
    if (!rig) throw std::runtime_error(core::to_string(rig.error()));
    rig_ = rig->get();
    if (auto added = supervisor_.add(std::move(*rig)); !added) throw std::runtime_error(core::to_string(added.error()));
    publisher_ =
        std::make_unique<ipc::PublishThread>(std::make_unique<CollectingSocket>(sent_), bell_, supervisor_.rigs(), clock_, kInstance);
  }

  std::vector<std::string> run() {
    supervisor_.start();
    static_cast<void>(publisher_->start({}));
    device_->give({.is_open = true});
    settle();
    for (const Step& step : golden_.steps) {
      try {
        take(step);
      } catch (const std::exception& error) {
        throw std::runtime_error(golden_.name + ".case:" + std::to_string(step.line) + ": " + error.what());
      }
    }
    post_status();
    supervisor_.stop();
    publish_notices();
    pass_barrier();  // answers do not go through the publish thread
    answer_waiting();
    publisher_->stop();
    return sent_.lines();
  }

 private:
  void take(const Step& step) {
    std::istringstream words(step.rest);
    std::uint64_t count = 0;
    if (step.verb == "run") {
      words >> count;
      deliver(count);
    } else if (step.verb == "ask") {
      ask(step.rest);
    } else if (step.verb == "status") {
      post_status();
    } else if (step.verb == "gap" || step.verb == "broken" || step.verb == "gone") {
      core::Gap gap{.reason = core::GapReason::Overrun, .missing_scans = 0, .is_exact = true};
      int reason = 0;
      words >> reason >> gap.missing_scans;
      gap.reason = static_cast<core::GapReason>(reason);
      gap.is_exact = gap.missing_scans > 0;
      clock_.advance_ns(time_of(gap.missing_scans));
      const auto outcome = step.verb == "gap"      ? device::ReadOutcome::Gap
                           : step.verb == "broken" ? device::ReadOutcome::Broken
                                                   : device::ReadOutcome::Gone;
      device_->give({.result = {outcome, gap}});
      settle();
    } else if (step.verb == "skip") {
      words >> skipped_;
      clock_.advance_ns(time_of(skipped_));
    } else if (step.verb == "pause") {
      words >> count;
      clock_.advance_ns(static_cast<std::int64_t>(count) * core::kNanosecondsPerMillisecond);
    } else if (step.verb == "timeout" || step.verb == "armed") {
      words >> count;
      for (std::uint64_t i = 0; i < count; ++i) {
        clock_.advance_ns(100 * core::kNanosecondsPerMillisecond);
        device_->give({.result = {step.verb == "armed" ? device::ReadOutcome::Armed : device::ReadOutcome::Timeout, {}}});
        settle();
      }
    } else if (step.verb == "open") {
      device_->give({.is_open = true, .succeeds = step.rest != "fails"});
      settle();
    } else {
      throw std::runtime_error("unknown step '" + step.verb + "'");
    }
  }

  std::int64_t time_of(std::uint64_t scans) const { return golden_.rig.rate.time_ns({scans}); }

  void deliver(std::uint64_t count) {
    while (count > 0) {
      const std::uint64_t scans = std::min<std::uint64_t>(count, golden_.rig.block_scans);
      if (next_row_ + scans > scans_.rows.size()) throw std::runtime_error("the recording is too short: DTS_GOLDEN_RECORD=1 makes it anew");
      const auto first = scans_.rows.begin() + static_cast<std::ptrdiff_t>(next_row_);
      const std::int64_t first_ns = clock_.now_ns();
      clock_.advance_ns(time_of(scans));
      device_->give({.result = {device::ReadOutcome::Scans, {}},
                     .rows = {first, first + static_cast<std::ptrdiff_t>(scans)},
                     .skipped = std::exchange(skipped_, 0),
                     .host_time_ns = first_ns});
      next_row_ += scans;
      count -= scans;
      settle();
    }
  }

  /// The rig's thread waits for the next turn. Waits for the pipeline and the publisher, and does what the daemon does in a turn.
  void settle() {
    wait_for_pipeline();
    pass_barrier();
    supervisor_.tick();
    finish_pending();
    publish_notices();
    pass_barrier();  // answers do not go through the publish thread
    answer_waiting();
    pass_barrier();
  }

  /// Waits for the other threads of the control thread: the recorder, and the worker with the analyses that the last tick began.
  void finish_pending() {
    while (rig_->tap().waiting() > rig_->tap().capacity() / 2) std::this_thread::sleep_for(std::chrono::microseconds(50));
    worker_.run([] {}).wait();
    supervisor_.tick();
    finish_stop();
  }

  /// Waits until the recording of a session that stops is closed.
  void finish_stop() {
    if (supervisor_.states().front().session.state != session::SessionState::Stopping) return;
    recordings_->wait_until_closed(kPatience);
    supervisor_.tick();
  }

  void wait_for_pipeline() {
    const session::AcquisitionReport acquired = rig_->acquisition();
    if (acquired.scans_total == 0) return;
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (true) {
      const session::PipelineReport& report = rig_->pipeline_report();
      if (report.end.segment == acquired.segment && report.next_scan.value == acquired.next_scan) return;
      if (std::chrono::steady_clock::now() > deadline) throw std::runtime_error("the stages hang");
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }

  /// A turn of the publisher looks at frames, then at posted messages. The first barrier may overtake a frame, the second cannot.
  void pass_barrier() {
    for (int turn = 0; turn < 2; ++turn) {
      publisher_->post(kBarrier, {});
      sent_.wait_for_barrier(++barriers_);
    }
  }

  void publish_notices() {
    for (session::Notice& notice : supervisor_.take_notices()) publisher_->post(notice.rig, std::move(notice.event));
  }

  void post_status() {
    publisher_->post(handler_.status());
    pass_barrier();
  }

  void ask(const std::string& text) {
    dts::v1::Request request;
    if (!google::protobuf::TextFormat::ParseFromString(text, &request)) throw std::runtime_error("this is no request: " + text);
    const auto answer = handler_.execute(request);
    if (answer.pending) {
      waiting_.push_back(*answer.pending);
    } else {
      sent_.add_line(line_of("", answer.response));
    }
    finish_stop();
    publish_notices();
    pass_barrier();  // answers do not go through the publish thread
    answer_waiting();
    pass_barrier();
  }

  void answer_waiting() {
    std::erase_if(waiting_, [this](const ipc::Pending& pending) {
      const auto response = handler_.finish(pending);
      if (response) sent_.add_line(line_of("", *response));
      return response.has_value();
    });
  }

  const Case& golden_;
  const Scans& scans_;
  GoldenClock clock_;
  core::Doorbell bell_;
  Sent sent_;
  Folder folder_;
  core::SystemClock disk_clock_;
  core::Worker worker_{"analyse"};
  std::unique_ptr<session::Recordings> recordings_ = open_recordings(folder_.path(), disk_clock_);
  session::Supervisor supervisor_;
  ipc::CommandHandler handler_;
  std::unique_ptr<ipc::PublishThread> publisher_;
  PlayedDevice* device_ = nullptr;
  session::Rig* rig_ = nullptr;
  std::vector<ipc::Pending> waiting_;
  std::size_t next_row_ = 0;
  std::uint64_t skipped_ = 0;
  std::uint64_t barriers_ = 0;
};

}  // namespace

std::vector<std::string> run(const Case& golden, const Scans& scans) { return Runner(golden, scans).run(); }

}  // namespace dts::golden
