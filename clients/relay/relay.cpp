// SPDX-License-Identifier: Apache-2.0
#include "relay/relay.h"

#include <signal.h>
#include <systemd/sd-daemon.h>

#include <string>
#include <utility>

#include "relay/authenticator.h"
#include "relay/control_relay.h"
#include "relay/data_relay.h"

namespace dts::relay {
namespace {

constexpr int kServeMs = 100;  // longest delay before a signal or a changed key is handled
constexpr std::int64_t kRetryNs = 1'000'000'000;
constexpr std::int64_t kReportNs = 10'000'000'000;  // at most one log line for rejected connections in this time

/// Returns true if SIGTERM or SIGINT has arrived.
bool is_end_requested() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
  const timespec at_once{};
  return sigtimedwait(&wanted, nullptr, &at_once) > 0;
}

/// Ends all connections after a key was revoked. Retries once a second if an address cannot be bound again, because another program bound
/// it first.
class Revocation {
 public:
  Revocation(FreshKeys& keys, ControlRelay& control, DataRelay& data, const core::Log& log)
      : keys_(keys), control_(control), data_(data), log_(log) {}

  void serve(std::int64_t now_ns) {
    keys_.look();
    if (keys_.store().take_losses()) {
      log_.info("a key was revoked or changed: all connections are closed, clients that are still authorised may reconnect immediately");
      drop(true, true, now_ns);
    } else if ((is_control_down_ || data_.is_down()) && now_ns >= retry_ns_) {
      log_.error("other machines cannot connect: another program uses the port of [network]. End it, or choose another port");
      drop(is_control_down_, data_.is_down(), now_ns);
    }
  }

 private:
  void drop(bool is_control_due, bool is_data_due, std::int64_t now_ns) {
    retry_ns_ = now_ns + kRetryNs;
    if (is_control_due) is_control_down_ = !control_.drop_peers();
    if (is_data_due) data_.drop_peers();
  }

  FreshKeys& keys_;
  ControlRelay& control_;
  DataRelay& data_;
  const core::Log& log_;
  bool is_control_down_ = false;
  std::int64_t retry_ns_ = 0;
};

/// Logs how many connections were accepted and rejected.
class ConnectionReport {
 public:
  ConnectionReport(const Authenticator& authenticator, const core::Log& log) : authenticator_(authenticator), log_(log) {}

  void serve(std::int64_t now_ns) {
    const std::uint64_t refused = authenticator_.refused_total();
    if (refused == reported_ || now_ns < next_ns_) return;
    next_ns_ = now_ns + kReportNs;
    log_.warning("rejected " + std::to_string(refused - std::exchange(reported_, refused)) +
                 " connections without a valid key, or too many at once; accepted since the start: " +
                 std::to_string(authenticator_.accepted_total()));
  }

 private:
  const Authenticator& authenticator_;
  const core::Log& log_;
  std::uint64_t reported_ = 0;
  std::int64_t next_ns_ = 0;
};

}  // namespace

core::Status run_relay(const Settings& settings, core::Clock& clock, const core::Log& log) {
  DTS_TRY_ASSIGN(const auto keys, FreshKeys::open(settings.key_directory, log));
  const access::ServerKey& server = keys->store().server();
  zmq::context_t context(1);
  // First and last: libzmq accepts every client without it.
  DTS_TRY_ASSIGN(const auto authenticator, Authenticator::start(context, *keys, clock));
  DTS_TRY_ASSIGN(auto control,
                 ControlRelay::open(context, {settings.network->control, server}, settings.local.control, keys->store(), clock, log));
  DTS_TRY_ASSIGN(const auto data, DataRelay::start(context, {settings.network->data, server}, settings.local.data));
  sd_notify(0, "READY=1");
  log.info("clients with keys connect to control on " + settings.network->control + " and data on " + settings.network->data);
  Revocation revocation(*keys, control, *data, log);
  ConnectionReport report(*authenticator, log);
  while (!is_end_requested()) {
    control.serve(kServeMs);
    revocation.serve(clock.now_ns());
    report.serve(clock.now_ns());
  }
  sd_notify(0, "STOPPING=1");
  log.info("stopping");
  return {};
}

}  // namespace dts::relay
