// SPDX-License-Identifier: Apache-2.0
#include "bench/child.h"

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>
#include <zmq.hpp>

#include "app/config.h"
#include "bench/process_use.h"
#include "core/clock.h"
#include "device/registry.h"
#include "dts/subscriber.h"
#include "dts/v1/stream.pb.h"

namespace dts::bench {
namespace {

constexpr std::size_t kMostSamples = 2'000'000;
constexpr int kPlainChannels = 16;
constexpr char kReady = 'r';
constexpr std::int64_t kSilenceNs = 5'000'000'000;

std::int64_t now_ns() { return core::SystemClock{}.now_ns(); }
std::int64_t to_ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

std::int64_t newest_ns(const client::Block& block) {
  return block.host_time_ns + std::llround(static_cast<double>(block.scan_count - 1) * 1e9 / block.rate.hz());
}

/// Counts the scans of one stream against the time that the device says has passed.
class ScanCount {
 public:
  void add(const client::Block& block) {
    if (measured_.received == 0) {
      first_ns_ = block.host_time_ns;
    } else {
      measured_.told_lost += block.lost_scans;
    }
    measured_.received += block.scan_count;
    const double elapsed_s = static_cast<double>(newest_ns(block) - first_ns_) * 1e-9;
    measured_.expected = static_cast<std::uint64_t>(std::llround(elapsed_s * block.rate.hz())) + 1;
  }
  void add(const client::Event& event) {
    if (measured_.received != 0 && event.body->has_gap()) measured_.gap_scans += event.body->gap().missing_scans();
  }
  [[nodiscard]] const Measured& measured() const noexcept { return measured_; }

 private:
  Measured measured_;
  std::int64_t first_ns_ = 0;
};

template <class Announce>
Measured receive_all(const std::string& endpoint, double seconds, Announce announce) {
  auto subscriber = client::Subscriber::open({.endpoint = endpoint, .topics = {"floor/"}});
  if (!subscriber) return {};
  Percentiles latency(kMostSamples);
  ScanCount count;
  // The window ends by the time of the data, not of their arrival: or the latest ones would not count.
  std::int64_t end_ns = 0;
  std::int64_t last_ns = 0;
  while (end_ns == 0 || (last_ns < end_ns && now_ns() < end_ns + kSilenceNs)) {
    const auto message = subscriber->receive(std::chrono::milliseconds(100));
    if (!message) return {};
    if (!*message) continue;
    if (const auto* event = std::get_if<client::Event>(&**message)) count.add(*event);
    const auto* block = std::get_if<client::Block>(&**message);
    if (block == nullptr || block->stream != "cop") continue;
    const std::int64_t arrived_ns = now_ns();
    if (end_ns == 0) {  // the first block says that the formats are known: everything is set up
      announce();
      end_ns = arrived_ns + to_ns(seconds);
      continue;
    }
    last_ns = newest_ns(*block);
    latency.add_ns(arrived_ns - last_ns);
    count.add(*block);
  }
  Measured measured = count.measured();
  measured.set(latency);
  return measured;
}

Measured tick_for(double rate_hz, double seconds) {
  core::SystemClock clock;
  Percentiles lateness(kMostSamples);
  const std::int64_t begin_ns = clock.now_ns() + core::kNanosecondsPerMillisecond;
  for (std::int64_t tick = 0; static_cast<double>(tick) < seconds * rate_hz; ++tick) {
    const std::int64_t due_ns = begin_ns + std::llround(static_cast<double>(tick) * 1e9 / rate_hz);
    clock.sleep_until_ns(due_ns);
    lateness.add_ns(clock.now_ns() - due_ns);
  }
  Measured measured;
  measured.set(lateness);
  return measured;
}

Measured send_plain(const std::string& endpoint, double rate_hz, double seconds) {
  core::SystemClock clock;
  zmq::context_t context(1);
  zmq::socket_t socket(context, zmq::socket_type::pub);
  socket.set(zmq::sockopt::linger, 0);
  socket.bind(endpoint);
  v1::StreamBlock block;
  block.set_instance_id(1);
  block.set_scan_count(1);
  block.set_channel_count(kPlainChannels);
  block.mutable_quality()->assign(kPlainChannels, '\0');
  const std::int64_t begin_ns = clock.now_ns() + core::kNanosecondsPerMillisecond;
  for (std::int64_t scan = 0; static_cast<double>(scan) < seconds * rate_hz; ++scan) {
    const std::int64_t due_ns = begin_ns + std::llround(static_cast<double>(scan) * 1e9 / rate_hz);
    clock.sleep_until_ns(due_ns);
    block.set_first_scan(static_cast<std::uint64_t>(scan));
    block.set_host_time_ns(due_ns);
    block.mutable_values()->Resize(kPlainChannels, 1.0F);
    zmq::message_t payload(block.ByteSizeLong());
    block.SerializeWithCachedSizesToArray(payload.data<std::uint8_t>());
    socket.send(zmq::str_buffer("floor/plain"), zmq::send_flags::sndmore);
    socket.send(payload, zmq::send_flags::none);
  }
  return {};
}

/// Reads until `end_ns` what a rig's device delivers.
void drain(const pipeline::RigConfig& rig, std::int64_t end_ns) {
  core::SystemClock clock;
  auto device = device::create_device(rig.device_uri, {clock, rig.model});
  if (!device || !(*device)->open() || !(*device)->start({rig.rate, rig.block_scans})) return;
  core::Block block((*device)->describe().channels.size(), rig.block_scans);
  while (clock.now_ns() < end_ns) static_cast<void>((*device)->read(block, end_ns));
}

Measured drain_all(const std::string& config_file, double seconds) {
  const app::LoadedConfig loaded = app::load_config(config_file);
  const std::int64_t begin_ns = now_ns() + to_ns(1.0);  // creating the devices is not measured
  std::vector<std::jthread> threads;
  for (const app::ConfiguredRig& rig : loaded.config.rigs) threads.emplace_back(drain, rig.rig, begin_ns + to_ns(seconds + 1.0));
  core::SystemClock().sleep_until_ns(begin_ns);
  const ObservedUse before = observe(::getpid());
  core::SystemClock().sleep_until_ns(begin_ns + to_ns(seconds));
  Measured measured;
  measured.cpu_percent = between(before, observe(::getpid())).threads_percent;
  return measured;
}

template <class Announce>
Measured take_plain(const std::string& endpoint, double seconds, Announce announce) {
  zmq::context_t context(1);
  zmq::socket_t socket(context, zmq::socket_type::sub);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::subscribe, "floor/");
  socket.connect(endpoint);
  Percentiles latency(kMostSamples);
  v1::StreamBlock block;
  std::int64_t end_ns = 0;
  while (end_ns == 0 || block.host_time_ns() < end_ns) {
    zmq::message_t topic;
    zmq::message_t payload;
    if (!socket.recv(topic) || !socket.recv(payload)) return {};
    if (!block.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) return {};
    const std::int64_t arrived_ns = now_ns();
    if (end_ns == 0) {
      announce();
      end_ns = arrived_ns + to_ns(seconds);
    } else {
      latency.add_ns(arrived_ns - block.host_time_ns());
    }
  }
  Measured measured;
  measured.set(latency);
  return measured;
}

}  // namespace

void Measured::set(Percentiles& latency) {
  latency.sort();
  p50_us = latency.us(0.5);
  p99_us = latency.us(0.99);
  p999_us = latency.us(0.999);
  max_us = latency.us(1.0);
  samples = latency.size();
}

Child::Child() {
  int ends[2] = {-1, -1};
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::fflush(nullptr);  // or the child prints it again
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("no process");
  read_fd_ = ends[0];
  write_fd_ = ends[1];
  if (pid_ == 0) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  } else {
    ::close(std::exchange(write_fd_, -1));
  }
}

Child::Child(Child&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)), read_fd_(std::exchange(other.read_fd_, -1)), write_fd_(std::exchange(other.write_fd_, -1)) {}

Child::~Child() {
  if (pid_ <= 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
  ::close(read_fd_);
}

void Child::become_realtime(int fifo_priority) {
  ::prctl(PR_SET_TIMERSLACK, 1UL);
  const sched_param parameters{.sched_priority = fifo_priority};
  if (fifo_priority > 0) ::sched_setscheduler(0, SCHED_FIFO, &parameters);
}

void Child::announce() const { static_cast<void>(::write(write_fd_, &kReady, 1) == 1); }

void Child::finish(const Measured& measured) const {
  const bool is_sent = ::write(write_fd_, &measured, sizeof measured) == static_cast<ssize_t>(sizeof measured);
  ::_exit(is_sent ? 0 : 1);
}

bool Child::wait_until_ready() const {
  char word = 0;
  return ::read(read_fd_, &word, 1) == 1 && word == kReady;
}

Measured Child::result() {
  Measured measured;
  if (::read(read_fd_, &measured, sizeof measured) != static_cast<ssize_t>(sizeof measured)) measured = {};
  ::waitpid(std::exchange(pid_, -1), nullptr, 0);
  ::close(read_fd_);
  return measured;
}

bool may_use_fifo(int priority) {
  Child trial(0, [priority](auto) {
    const sched_param parameters{.sched_priority = priority};
    return Measured{.samples = ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0 ? 1U : 0U};
  });
  return trial.result().samples == 1;
}

Child subscribe(const std::string& endpoint, double seconds, int fifo_priority) {
  return Child(fifo_priority, [=](auto announce) { return receive_all(endpoint, seconds, announce); });
}

Child run_devices(const std::string& config_file, double seconds) {
  return Child(0, [=](auto) { return drain_all(config_file, seconds); });
}

Child tick(double rate_hz, double seconds, int fifo_priority) {
  return Child(fifo_priority, [=](auto) { return tick_for(rate_hz, seconds); });
}

Child publish_plain(const std::string& endpoint, double rate_hz, double seconds, int fifo_priority) {
  return Child(fifo_priority, [=](auto) { return send_plain(endpoint, rate_hz, seconds); });
}

Child receive_plain(const std::string& endpoint, double seconds, int fifo_priority) {
  return Child(fifo_priority, [=](auto announce) { return take_plain(endpoint, seconds, announce); });
}

}  // namespace dts::bench
