// SPDX-License-Identifier: Apache-2.0
#include "app/daemon.h"

#include <malloc.h>
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
#include "app/plate_check.h"
#include "app/progress_watch.h"
#include "app/service_manager.h"
#include "core/thread.h"
#include "core/worker.h"
#include "device/registry.h"
#include "files/protocol_file.h"
#include "ipc/control_server.h"
#include "ipc/endpoint.h"
#include "ipc/local_publisher.h"
#include "ipc/publish_thread.h"
#include "session/supervisor.h"

namespace dts::app {
namespace {

constexpr int kServeMs = 100;  // longest delay before a signal is handled

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

/// Sets the policy of libzmq's own threads. libzmq aborts the process if the system rejects the policy, so a probe thread tries it first.
void schedule_zmq(zmq::context_t& context, const core::ThreadPolicy& policy) {
  if (policy.fifo_priority == 0) return;
  bool is_allowed = false;
  std::thread([&] { is_allowed = core::configure_this_thread("probe", policy).empty(); }).join();
  if (!is_allowed) return;
  zmq_ctx_set(context.handle(), ZMQ_THREAD_SCHED_POLICY, SCHED_FIFO);
  zmq_ctx_set(context.handle(), ZMQ_THREAD_PRIORITY, policy.fifo_priority);
}

/// Returns the signal that arrived, or 0.
int pending_signal() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&wanted, signal);
  const timespec at_once{};
  return std::max(0, sigtimedwait(&wanted, nullptr, &at_once));
}

/// Handles SIGHUP: reads the keys again. If the file is damaged, keeps the previous keys.
void reload_keys(access::KeyStore* keys, const core::Log& log) {
  if (keys == nullptr) return log.error("SIGHUP: dtsd could not read its keys when it started; correct them and restart dtsd");
  if (auto reloaded = keys->reload(); !reloaded) return log.error("SIGHUP: " + core::to_string(reloaded.error()));
  log.info("SIGHUP: " + std::to_string(keys->keys().size()) + " client key(s)");
}

/// Sends keep-alives to systemd's watchdog while all parts make progress. Logs once which part does not.
class WatchdogFeeder {
 public:
  WatchdogFeeder(ServiceManager& manager, session::Supervisor& supervisor, const ipc::PublishThread& publisher, const core::Log& log)
      : manager_(manager), supervisor_(supervisor), publisher_(publisher), log_(log) {}

  void feed(std::int64_t now_ns) {
    if (now_ns - looked_ns_ < kLookNs) return;
    looked_ns_ = now_ns;
    const std::string stuck = watch_.stuck_part(supervisor_.states(), publisher_.turns(), now_ns);
    for (const std::string& hang : watch_.new_hangs()) log_.error(hang);
    if (!stuck.empty() && reported_.empty())
      log_.error(
          stuck +
          " makes no progress: dtsd no longer notifies systemd's watchdog, so systemd restarts it; without systemd, restart it yourself");
    reported_ = stuck;
    if (stuck.empty() && manager_.is_keep_alive_due(now_ns)) manager_.keep_alive(now_ns);
  }

 private:
  static constexpr std::int64_t kLookNs = 1'000'000'000;
  static constexpr std::int64_t kPatienceNs = 4'000'000'000;  // longer than any pause of a healthy machine, shorter than WatchdogSec

  ServiceManager& manager_;
  session::Supervisor& supervisor_;
  const ipc::PublishThread& publisher_;
  const core::Log& log_;
  ProgressWatch watch_{kPatienceNs};
  std::int64_t looked_ns_ = 0;
  std::string reported_;
};

void serve_until_signal(ipc::ControlServer& server, access::KeyStore* keys, ServiceManager& manager, WatchdogFeeder feeder,
                        const core::Clock& clock, const core::Log& log) {
  while (true) {
    server.serve(kServeMs);
    feeder.feed(clock.now_ns());
    switch (pending_signal()) {
      case SIGTERM:
      case SIGINT: return;
      case SIGHUP:
        manager.reloading(clock.now_ns());
        reload_keys(keys, log);
        manager.ready("serving");
        break;
      default: break;
    }
  }
}

}  // namespace

std::string_view version() noexcept { return DTS_VERSION; }

namespace {

/// Reports two rigs with the same device: only the one that opens it first would work, and that would be random.
void check_competitors(const DaemonConfig& config, files::Problems& problems) {
  for (std::size_t later = 1; later < config.rigs.size(); ++later) {
    for (std::size_t earlier = 0; earlier < later; ++earlier) {
      const pipeline::RigConfig& one = config.rigs[earlier].rig;
      const pipeline::RigConfig& other = config.rigs[later].rig;
      if (!device::compete(one.device_uri, other.device_uri)) continue;
      problems.push_back(config.rigs[later].where);
      problems.back().text =
          "[[rig]] '" + other.name + "' and '" + one.name + "' could open the same unit: add serial=... to the device of each";
    }
  }
}

}  // namespace

std::vector<std::unique_ptr<session::Rig>> create_rigs(const DaemonConfig& config, core::Clock& clock, core::Doorbell& bell,
                                                       device::usb::UsbBus& usb, const core::Log& log, files::Problems& problems) {
  std::vector<std::unique_ptr<session::Rig>> rigs;
  for (const ConfiguredRig& configured : config.rigs) {
    auto rig = session::Rig::create(configured.rig, clock, bell, &usb, {.are_allowed = config.allows_programs, .log = log});
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

namespace {

/// Locks of both folders: no other daemon can use them while this object exists.
struct Folders {
  DirectoryLock runtime;
  DirectoryLock state;
};

core::Result<Folders> take_folders(const DaemonConfig& config) {
  DTS_TRY(prepare_directory(config.runtime_directory));
  DTS_TRY_ASSIGN(auto runtime, DirectoryLock::take(config.runtime_directory));
  DTS_TRY(prepare_directory(config.storage.directory, "DTSD_STATE_DIR"));
  DTS_TRY_ASSIGN(auto state, DirectoryLock::take(config.storage.directory, "DTSD_STATE_DIR"));
  return Folders{std::move(runtime), std::move(state)};
}

/// Returns notices for the log and the status: what the configuration asks for and this machine cannot do.
std::vector<std::string> first_notices(const DaemonConfig& config, bool has_rigs) {
  std::vector<std::string> notices;
  // State after installation. The daemon must run anyway: dtsctl device list needs it and shows what to write in the configuration.
  if (!has_rigs)
    notices.emplace_back("no rig is configured: find your device with dtsctl device list, then add a [[rig]] to the configuration");
  for (const files::Problem& warning : plate_warnings(config)) notices.push_back(to_string(warning));
  if (!config.realtime.locks_memory) return notices;
  if (auto locked = core::lock_memory(); !locked) notices.push_back(core::to_string(locked.error()));
  return notices;
}

}  // namespace

core::Status run_daemon(const DaemonConfig& config, std::vector<std::unique_ptr<session::Rig>> rigs, std::vector<std::string> notices,
                        core::Clock& clock, core::Doorbell& bell, device::usb::UsbBus& usb, core::Log log) {
  const auto folders = take_folders(config);
  if (!folders) return tl::make_unexpected(folders.error());
  for (std::string& notice : first_notices(config, !rigs.empty())) notices.push_back(std::move(notice));
  ::umask(0007);  // sockets, catalogue and recordings: only for owner and group
  DTS_TRY_ASSIGN(auto recordings, session::Recordings::open(config.storage, clock, log));
  if (!recordings->notice().empty()) notices.push_back(recordings->notice());
  const std::string boot = boot_id();
  core::Worker worker("analyse");
  session::Supervisor supervisor(clock, log, &usb,
                                 {.recordings = *recordings,
                                  .worker = worker,
                                  .protocols = config.protocols,
                                  .label_rule = config.label_rule,
                                  .software = "dtsd " + std::string(version()),
                                  .boot_id = boot,
                                  .ports_root = "",
                                  .planned_trials = files::planned_trials});
  for (auto& rig : rigs) {
    DTS_TRY(supervisor.add(std::move(rig)));
  }
  const ipc::Identity identity{
      .instance_id = random_id(), .version = std::string(version()), .boot_id = boot, .started_ns = clock.now_ns()};

  auto opened_keys = access::KeyStore::open(config.key_directory);
  if (!opened_keys && config.network) return tl::make_unexpected(opened_keys.error());
  if (!opened_keys) notices.push_back(core::to_string(opened_keys.error()));  // without [network] no client needs a key
  access::KeyStore* const keys = opened_keys ? opened_keys->get() : nullptr;
  zmq::context_t context(1);
  schedule_zmq(context, config.realtime.policy(2));
  DTS_TRY_ASSIGN(auto control, ipc::ControlSocket::bind(context, config.endpoints.control));
  DTS_TRY_ASSIGN(auto data, ipc::LocalPublisher::bind(config.endpoints.data, clock, log));
  ipc::PublishThread publisher(std::move(data), bell, supervisor.rigs(), clock, identity.instance_id);
  for (std::string& refused : publisher.start(config.realtime.policy(1))) notices.push_back(std::move(refused));
  for (const std::string& notice : notices) log.warning(notice);
  ipc::CommandHandler handler(supervisor, clock, identity, notices,
                              {keys, clock, config.network, opened_keys ? core::Error{} : opened_keys.error()});
  ipc::ControlServer server(std::move(control), access::Gate(keys), supervisor, handler, publisher, clock, log);

  supervisor.start();
  supervisor.resume_interrupted();
  ServiceManager manager;
  manager.ready("serving " + std::to_string(supervisor.rigs().size()) + " rig(s)");
  log.info("dtsd " + identity.version + " serves control on " + config.endpoints.control + " and data on " + config.endpoints.data);
  ::malloc_trim(0);  // the start needed 4 MB more than what is kept
  serve_until_signal(server, keys, manager, {manager, supervisor, publisher, log}, clock, log);
  manager.stopping();
  log.info("stopping");
  supervisor.stop();
  server.publish_notices();
  server.answer_waiting();
  publisher.stop();
  for (const std::string& endpoint : {config.endpoints.control, config.endpoints.data}) ipc::remove_socket_file(endpoint);
  return {};
}

}  // namespace dts::app
