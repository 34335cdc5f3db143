// SPDX-License-Identifier: Apache-2.0
// dtsd as one peer among those of a benchmark that compares ways from a producer to a consumer:
//
//   role=prod  the daemon's own parts, wired as app/daemon.cpp does, behind a device that follows the benchmark's schedule
//   role=cons  a client
//
// Both take the driver's arguments (rate= chunk= secs= nsub= ...), talk with it over stdin and stdout (peer_protocol.h) and
// end with one line of JSON. Further arguments:
//   ep=ADDRESS       data endpoint, ipc:///PATH
//   load=raw|floor   raw: 16 sensors, stage guard, stream raw. floor: 4 sensors and 12 further channels, four stages, five streams
//   cpu=N            rig thread and publisher on core N, as the daemon's realtime.cpus
//   client=own|stock own: libdts, which reads the socket itself. stock: a SUB socket of libzmq and protobuf, as other programs have
//   mode=all|latest  of the own client
//   hwm=N            messages that the stock client queues
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <span>
#include <thread>
#include <zmq.hpp>

#include "bench/peer_protocol.h"
#include "bench/scheduled_device.h"
#include "bench/timed_socket.h"
#include "core/thread.h"
#include "core/worker.h"
#include "dts/subscriber.h"
#include "dts/v1/stream.pb.h"
#include "ipc/control_server.h"
#include "ipc/local_publisher.h"
#include "ipc/publish_thread.h"
#include "session/recordings.h"
#include "session/supervisor.h"

namespace dts::bench {
namespace {

constexpr std::size_t kChannels = 16;
constexpr const char* kRig = "bench";
constexpr const char* kDefaultEndpoint = "ipc:///tmp/peer_dtsd.sock";
constexpr int kServeMs = 100;
constexpr std::uint64_t kInstance = 1;

/// For what a benchmark cannot go on without.
template <class T>
T need(core::Result<T> result) {
  if (result) return std::move(*result);
  std::fprintf(stderr, "peer_dtsd: %s\n", core::to_string(result.error()).c_str());
  std::exit(1);
}

void need(const core::Status& done) {
  if (done) return;
  std::fprintf(stderr, "peer_dtsd: %s\n", core::to_string(done.error()).c_str());
  std::exit(1);
}

/// The policy of a thread `steps_below` the one that this process was started with (chrt), as the daemon's configuration does it.
core::ThreadPolicy policy(const Arguments& arguments, int fifo_priority, int steps_below) {
  core::ThreadPolicy policy{.fifo_priority = std::max(0, fifo_priority - steps_below), .cpus = {}};
  if (const double cpu = arguments.number("cpu", -1.0); cpu >= 0.0) policy.cpus = {static_cast<int>(cpu)};
  return policy;
}

/// Takes SCHED_FIFO off the calling thread, the daemon's control thread, and tells what it was; 0 without it.
int take_fifo_priority() {
  if (sched_getscheduler(0) != SCHED_FIFO) return 0;
  sched_param parameters{};
  sched_getparam(0, &parameters);
  const sched_param none{};
  sched_setscheduler(0, SCHED_OTHER, &none);
  return parameters.sched_priority;
}

pipeline::RigConfig rig_config(const Arguments& arguments, const Plan& plan, int fifo_priority) {
  const bool is_floor = arguments.text("load", "raw") == "floor";
  pipeline::RigConfig config{.name = kRig, .kind = "floor", .device_uri = "bench:schedule", .model = {}, .block_scans = plan.chunk};
  config.rate = need(core::Rate::from_hz(plan.rate_hz));
  config.model.support = {.kind = physics::SupportKind::Corner, .inset = {10.75}};
  const std::size_t per_side = is_floor ? 2 : 4;
  const double pitch_mm = is_floor ? 258.0 : 86.0;  // the floor platform's sensors at 86 and 344 mm; raw: a grid from 86 mm on
  for (std::size_t sensor = 0; sensor < per_side * per_side; ++sensor) {
    const physics::Point position{.x = {86.0 + pitch_mm * static_cast<double>(sensor % per_side)},
                                  .y = {86.0 + pitch_mm * static_cast<double>(sensor / per_side)}};
    config.model.sensors.push_back(
        {.label = "w" + std::to_string(sensor + 1), .position = position, .curve = physics::SensorCurve::hoa1405_assumed()});
    config.sensor_channels.push_back(sensor);
  }
  config.stages.push_back({.id = "guard", .options = {}});
  config.published = {"raw"};
  if (is_floor) {
    for (const char* stage : {"window_filter", "linearise", "cop"}) config.stages.push_back({.id = stage, .options = {}});
    config.published = {"raw", "filtered", "deflection", "cop", "aux"};
  }
  config.policy = policy(arguments, fifo_priority, 0);
  return config;
}

void schedule_zmq(zmq::context_t& context, int fifo_priority) {
  if (fifo_priority <= 0) return;
  zmq_ctx_set(context.handle(), ZMQ_THREAD_SCHED_POLICY, SCHED_FIFO);
  zmq_ctx_set(context.handle(), ZMQ_THREAD_PRIORITY, fifo_priority);
}

/// Without it a subscriber does not tell how old its data are.
std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

/// A directory for the control socket, gone with this object.
class TemporaryDirectory {
 public:
  TemporaryDirectory() : path_((std::filesystem::temp_directory_path() / "dts-bench-XXXXXX").string()) {
    if (::mkdtemp(path_.data()) == nullptr) std::exit(1);
  }
  ~TemporaryDirectory() { std::filesystem::remove_all(path_); }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  std::string path_;
};

/// The daemon's parts at work, from the device to the socket, with the control loop on the calling thread.
class Producer {
 public:
  Producer(const Arguments& arguments, const Plan& plan, int fifo_priority)
      : plan_(plan), config_(rig_config(arguments, plan, fifo_priority)), figures_(plan.total_messages * config_.published.size()) {
    auto device = std::make_unique<ScheduledDevice>(plan, kChannels, config_.rate, arguments.count("tick_us", 0) * 1000, clock_);
    device_ = device.get();
    auto rig = need(session::Rig::create(config_, std::move(device), clock_, bell_));
    rig_ = rig.get();
    need(supervisor_.add(std::move(rig)));
    schedule_zmq(context_, std::max(0, fifo_priority - 2));
    auto socket = need(ipc::LocalPublisher::bind(arguments.text("ep", kDefaultEndpoint), clock_, core::Log()));
    auto timed = std::make_unique<TimedSocket>(std::move(socket), plan.warm_scans(), config_.rate, clock_, figures_);
    publisher_.emplace(std::move(timed), bell_, supervisor_.rigs(), clock_, kInstance);
    for (const std::string& refused : publisher_->start(policy(arguments, fifo_priority, 1))) std::fprintf(stderr, "%s\n", refused.c_str());
    keys_ = need(access::KeyStore::open(directory_.path() + "/keys"));
    handler_.emplace(supervisor_, clock_, ipc::Identity{.instance_id = kInstance, .boot_id = boot_id(), .started_ns = clock_.now_ns()},
                     std::vector<std::string>{}, ipc::KeyCommands(keys_.get(), clock_, {}));
    auto control = need(ipc::ControlSocket::bind(context_, "ipc://" + directory_.path() + "/control.sock"));
    server_.emplace(std::move(control), access::Gate(keys_.get()), supervisor_, *handler_, *publisher_, clock_, core::Log());
    supervisor_.start();
  }

  template <class Condition>
  void serve_while(Condition condition) {
    while (condition()) server_->serve(kServeMs);
  }
  void serve_for(std::uint64_t ms) {
    const std::int64_t until_ns = clock_.now_ns() + static_cast<std::int64_t>(ms) * core::kNanosecondsPerMillisecond;
    serve_while([&] { return clock_.now_ns() < until_ns; });
  }
  void send_everything() {
    device_->begin(clock_.now_ns() + core::kNanosecondsPerMillisecond);
    serve_while([&] { return !device_->is_done(); });
  }
  void stop() {
    supervisor_.stop();
    publisher_->stop();
  }
  /// After `stop`.
  [[nodiscard]] JsonLine report();

 private:
  Plan plan_;
  pipeline::RigConfig config_;
  core::SystemClock clock_;
  core::Doorbell bell_;
  TimedSocket::Figures figures_;
  TemporaryDirectory directory_;
  ScheduledDevice* device_ = nullptr;
  session::Rig* rig_ = nullptr;
  std::unique_ptr<session::Recordings> recordings_ = need(session::Recordings::open({.directory = directory_.path()}, clock_, core::Log()));
  core::Worker worker_{"analyse"};
  session::Supervisor supervisor_{clock_, core::Log(), nullptr, {.recordings = *recordings_, .worker = worker_}};
  zmq::context_t context_{1};
  std::optional<ipc::PublishThread> publisher_;
  std::unique_ptr<access::KeyStore> keys_;
  std::optional<ipc::CommandHandler> handler_;
  std::optional<ipc::ControlServer> server_;
};

JsonLine Producer::report() {
  const ProcessUse& begin = device_->use_at_begin();
  const ProcessUse& end = device_->use_at_end();
  const double wall_s = static_cast<double>(end.at_ns - begin.at_ns) * 1e-9;
  const auto measured = static_cast<double>(std::max<std::uint64_t>(1, plan_.total_messages - plan_.warm_messages));
  figures_.send.sort();
  figures_.age.sort();
  JsonLine line;
  line.add("role", std::string_view("prod")).add("peer", std::string_view("dtsd")).add("rate", plan_.rate_hz);
  line.add("chunk", std::uint64_t{plan_.chunk}).add("msgs", plan_.total_messages);
  line.add("refused", rig_->published().lost_frames).add("lost_before_pipeline", rig_->acquisition().losses.total().scans);
  line.add("achieved", measured * static_cast<double>(plan_.chunk) / wall_s);
  line.add("push_p50", figures_.send.us(0.5)).add("push_p99", figures_.send.us(0.99)).add("push_max", figures_.send.us(1.0));
  line.add("age_at_push_p50", figures_.age.us(0.5)).add("age_at_push_p99", figures_.age.us(0.99));
  line.add("late_max", static_cast<double>(device_->latest_ns()) * 1e-3);
  line.add("turn_max", static_cast<double>(device_->longest_turn_ns()) * 1e-3);
  line.add("cpu_pct", 100.0 * (end.cpu_s - begin.cpu_s) / wall_s);
  line.add("cs_per_msg", static_cast<double>(end.context_switches - begin.context_switches) / measured);
  return line.add("rss0", static_cast<std::uint64_t>(begin.resident_kb)).add("rss", static_cast<std::uint64_t>(end.resident_kb));
}

int produce(const Arguments& arguments) {
  const int fifo_priority = take_fifo_priority();
  Producer producer(arguments, Plan(arguments), fifo_priority);
  say("UP");
  producer.serve_while([] { return !is_told_to_go(); });
  producer.serve_for(arguments.count("settle_ms", 500));
  producer.send_everything();
  producer.serve_for(arguments.count("linger_ms", 300));
  producer.stop();
  producer.report().print();
  producer.serve_for(arguments.count("exit_ms", 300));
  return 0;
}

/// Counts the losses that the client library reports, and the age of the first data after each pause of this process (it was stopped).
struct LossReport {
  static constexpr std::int64_t kPauseNs = 1'000'000'000;

  std::uint64_t told_lost = 0;
  bool is_exact = true;
  std::int64_t last_ns = 0;
  std::optional<std::int64_t> oldest_after_pause_ns;

  void take(const client::Block& block, std::int64_t now_ns) {
    told_lost += block.lost_scans;
    is_exact = is_exact && block.is_lost_exact;
    if (last_ns != 0 && now_ns - last_ns > kPauseNs) oldest_after_pause_ns = std::max(block.age_ns, oldest_after_pause_ns);
    last_ns = now_ns;
  }
  void add_to(JsonLine& line) const {
    line.add("told_lost", told_lost).add("told_exact", std::uint64_t{is_exact});
    if (oldest_after_pause_ns) line.add("oldest_after_pause_us", static_cast<double>(*oldest_after_pause_ns) * 1e-3);
  }
};

/// The rig's topics, and the stream whose blocks are counted.
struct Wanted {
  std::string topics;
  std::string stream;
  explicit Wanted(const Arguments& arguments) {
    const bool is_floor = arguments.text("load", "raw") == "floor";
    topics = std::string(kRig) + (is_floor ? "/" : "/raw");
    stream = is_floor ? "cop" : "raw";
  }
};

int consume(const Arguments& arguments) {
  const Plan plan(arguments);
  const core::SystemClock clock;
  const Wanted wanted(arguments);
  auto subscriber =
      client::Subscriber::open({.endpoint = arguments.text("ep", kDefaultEndpoint),
                                .topics = {wanted.topics},
                                .mode = arguments.text("mode", "all") == "latest" ? client::Mode::Latest : client::Mode::All});
  while (subscriber && subscriber->status() == nullptr) {
    if (!subscriber->receive(std::chrono::milliseconds(50))) return 1;
  }
  if (!subscriber) return 1;
  say("READY");
  ConsumerFigures figures(plan);
  LossReport losses;
  const std::chrono::milliseconds patience(arguments.count("idle_ms", 3000));
  std::int64_t received_ns = clock.now_ns();
  while (!figures.is_done()) {
    const auto message = subscriber->receive(patience);
    // A process that was stopped gets no message at first: that is no silence.
    const bool is_silent = clock.now_ns() - received_ns >= patience.count() * core::kNanosecondsPerMillisecond;
    if (!message || (!*message && figures.has_started() && is_silent)) break;
    const client::Block* block = *message ? std::get_if<client::Block>(&**message) : nullptr;
    if (block == nullptr || block->stream != wanted.stream) continue;
    const std::int64_t now_ns = clock.now_ns();
    received_ns = now_ns;
    const auto length_ns = static_cast<std::int64_t>(static_cast<double>(block->scan_count - 1) * 1e9 / block->rate.hz());
    figures.take(block->first_scan, block->scan_count, block->host_time_ns + length_ns, now_ns);
    if (figures.has_started()) losses.take(*block, now_ns);
  }
  JsonLine line = figures.report("dtsd");
  losses.add_to(line);
  line.print();
  return 0;
}

int consume_with_zmq(const Arguments& arguments) {
  const Plan plan(arguments);
  const core::SystemClock clock;
  const Wanted wanted(arguments);
  const std::string counted = std::string(kRig) + "/" + wanted.stream;
  zmq::context_t context(1);
  zmq::socket_t socket(context, zmq::socket_type::sub);
  socket.set(zmq::sockopt::linger, 0);
  socket.set(zmq::sockopt::rcvhwm, static_cast<int>(arguments.count("hwm", 1000)));
  socket.set(zmq::sockopt::rcvtimeo, static_cast<int>(arguments.count("idle_ms", 3000)));
  socket.set(zmq::sockopt::subscribe, wanted.topics);
  socket.connect(arguments.text("ep", kDefaultEndpoint));
  say("READY");  // the driver's producer waits longer than the subscription takes
  ConsumerFigures figures(plan);
  zmq::message_t topic;
  zmq::message_t payload;
  v1::StreamBlock block;
  while (!figures.is_done()) {
    if (!socket.recv(topic)) {
      if (figures.has_started()) break;
      continue;
    }
    if (!socket.recv(payload) || topic.to_string_view() != counted) continue;
    if (!block.ParseFromArray(payload.data(), static_cast<int>(payload.size()))) return 1;
    const std::int64_t now_ns = clock.now_ns();
    const double period_ns = 1e9 * static_cast<double>(block.rate().denominator()) / static_cast<double>(block.rate().numerator());
    const auto length_ns = static_cast<std::int64_t>(static_cast<double>(block.scan_count() - 1) * period_ns);
    figures.take(block.first_scan(), block.scan_count(), block.host_time_ns() + length_ns, now_ns);
  }
  figures.report("dtsd").print();
  return 0;
}

}  // namespace
}  // namespace dts::bench

int main(int argc, char** argv) {
  const dts::bench::Arguments arguments(std::span<char* const>(argv, static_cast<std::size_t>(argc)));
  const std::string role = arguments.text("role", "");
  if (role == "prod") return dts::bench::produce(arguments);
  if (role == "cons" && arguments.text("client", "own") == "stock") return dts::bench::consume_with_zmq(arguments);
  if (role == "cons") return dts::bench::consume(arguments);
  std::fprintf(stderr, "peer_dtsd: started by tests/bench/peers.py with role=prod or role=cons\n");
  return 2;
}
