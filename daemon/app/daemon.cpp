// SPDX-License-Identifier: Apache-2.0
#include "app/daemon.h"

#include <sched.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <thread>
#include <utility>
#include <zmq.hpp>

#include "app/paths.h"
#include "app/service_manager.h"
#include "core/thread.h"
#include "device/registry.h"
#include "ipc/control_server.h"
#include "ipc/endpoint.h"
#include "ipc/publish_thread.h"
#include "ipc/xpub_socket.h"
#include "session/supervisor.h"

namespace dts::app {
namespace {

constexpr int kServeMs = 100;  // how soon a signal is seen
constexpr double kSubscriberQueueMs = 2000.0;
constexpr int kShortestSubscriberQueue = 1000;

std::uint64_t random_id() {
  std::random_device source;
  return (std::uint64_t{source()} << 32U) | source();
}

std::string boot_id() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  std::getline(file, id);
  return id;
}

/// Messages that all rigs together publish in `kSubscriberQueueMs`: what a slow subscriber may lag behind.
int subscriber_queue(const std::vector<session::Rig*>& rigs) {
  double messages = 0.0;
  for (const session::Rig* rig : rigs) {
    const double blocks =
        static_cast<double>(rig->config().rate.scans_in_ms(kSubscriberQueueMs)) / static_cast<double>(rig->config().block_scans);
    messages += blocks * static_cast<double>(rig->config().published.size());
  }
  return std::max(kShortestSubscriberQueue, static_cast<int>(messages));
}

/// libzmq's own thread inherits no policy of ours, and aborts the process when the one it is given is refused: try first.
void schedule_zmq(zmq::context_t& context, const core::ThreadPolicy& policy) {
  if (policy.fifo_priority == 0) return;
  bool is_allowed = false;
  std::thread([&] { is_allowed = core::configure_this_thread("probe", policy).empty(); }).join();
  if (!is_allowed) return;
  zmq_ctx_set(context.handle(), ZMQ_THREAD_SCHED_POLICY, SCHED_FIFO);
  zmq_ctx_set(context.handle(), ZMQ_THREAD_PRIORITY, policy.fifo_priority);
}

/// The signal that arrived, or 0.
int pending_signal() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&wanted, signal);
  const timespec at_once{};
  return std::max(0, sigtimedwait(&wanted, nullptr, &at_once));
}

void serve_until_signal(ipc::ControlServer& server, ServiceManager& manager, const core::Clock& clock, const core::Log& log) {
  while (true) {
    server.serve(kServeMs);
    manager.keep_alive(clock.now_ns());
    switch (pending_signal()) {
      case SIGTERM:
      case SIGINT: return;
      case SIGHUP:
        manager.reloading(clock.now_ns());
        log.info("SIGHUP: no client keys are configured, nothing to reload");
        manager.ready("serving");
        break;
      default: break;
    }
  }
}

}  // namespace

std::string_view version() noexcept { return DTS_VERSION; }

namespace {

/// Two rigs on one unit: whoever opens it first would have it, and which one that is would be chance.
void check_competitors(const DaemonConfig& config, files::Problems& problems) {
  for (std::size_t later = 1; later < config.rigs.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const pipeline::RigConfig& one = config.rigs[earlier].rig;
      const pipeline::RigConfig& other = config.rigs[later].rig;
      if (!device::compete(one.device_uri, other.device_uri)) continue;
      problems.push_back(config.rigs[later].where);
      problems.back().text = "[[rig]] '" + other.name + "' and '" + one.name + "' could open the same unit: give each its serial=...";
    }
  }
}

}  // namespace

std::vector<std::unique_ptr<session::Rig>> create_rigs(const DaemonConfig& config, core::Clock& clock, core::Doorbell& bell,
                                                       device::usb::UsbBus& usb, files::Problems& problems) {
  std::vector<std::unique_ptr<session::Rig>> rigs;
  for (const ConfiguredRig& configured : config.rigs) {
    auto rig = session::Rig::create(configured.rig, clock, bell, &usb);
    if (rig) {
      rigs.push_back(std::move(*rig));
    } else {
      problems.push_back(configured.where);
      problems.back().text = "[[rig]] '" + configured.rig.name + "' (" + configured.rig_file + "): " + core::to_string(rig.error());
    }
  }
  check_competitors(config, problems);
  return rigs;
}

core::Status run_daemon(const DaemonConfig& config, std::vector<std::unique_ptr<session::Rig>> rigs, core::Clock& clock,
                        core::Doorbell& bell, device::usb::UsbBus& usb, core::Log log) {
  if (auto made = prepare_directory(config.runtime_directory); !made) return made;
  const auto lock = DirectoryLock::take(config.runtime_directory);
  if (!lock) return tl::make_unexpected(lock.error());
  if (auto made = prepare_directory(config.storage.directory, "DTSD_STATE_DIR"); !made) return made;
  const auto state_lock = DirectoryLock::take(config.storage.directory, "DTSD_STATE_DIR");
  if (!state_lock) return tl::make_unexpected(state_lock.error());

  std::vector<std::string> notices;
  if (config.realtime.locks_memory) {
    if (auto locked = core::lock_memory(); !locked) notices.push_back(core::to_string(locked.error()));
  }
  ::umask(0007);  // sockets, catalogue and recordings: for owner and group
  auto recordings = session::Recordings::open(config.storage, clock, log);
  if (!recordings) return tl::make_unexpected(recordings.error());
  const std::string boot = boot_id();
  session::Supervisor supervisor(
      clock, log, &usb,
      {.recordings = recordings->get(), .protocols = config.protocols, .software = "dtsd " + std::string(version()), .boot_id = boot});
  for (auto& rig : rigs) {
    if (auto added = supervisor.add(std::move(rig)); !added) return added;
  }
  const ipc::Identity identity{
      .instance_id = random_id(), .version = std::string(version()), .boot_id = boot, .started_ns = clock.now_ns()};

  zmq::context_t context(1);
  schedule_zmq(context, config.realtime.policy(3));
  auto data = ipc::XpubSocket::bind(context, config.data_endpoint, subscriber_queue(supervisor.rigs()));
  if (!data) return tl::make_unexpected(data.error());
  ipc::PublishThread publisher(std::move(*data), bell, supervisor.rigs(), clock, identity.instance_id);
  for (std::string& refused : publisher.start(config.realtime.policy(2))) notices.push_back(std::move(refused));
  for (const std::string& notice : notices) log.warning(notice);
  ipc::CommandHandler handler(supervisor, clock, identity, notices);
  auto server = ipc::ControlServer::bind(context, config.control_endpoint, supervisor, handler, publisher, clock, identity.instance_id);
  if (!server) return tl::make_unexpected(server.error());

  supervisor.start();
  ServiceManager manager;
  manager.ready("serving " + std::to_string(supervisor.rigs().size()) + " rig(s)");
  log.info("dtsd " + identity.version + " serves control on " + config.control_endpoint + " and data on " + config.data_endpoint);
  serve_until_signal(**server, manager, clock, log);
  manager.stopping();
  log.info("stopping");
  supervisor.stop();
  (*server)->publish_notices();
  (*server)->answer_waiting();
  publisher.stop();
  for (const std::string& endpoint : {config.control_endpoint, config.data_endpoint}) ipc::remove_socket_file(endpoint);
  return {};
}

}  // namespace dts::app
