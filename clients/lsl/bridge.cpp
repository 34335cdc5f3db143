// SPDX-License-Identifier: Apache-2.0
#include "lsl/bridge.h"

#include <signal.h>
#include <systemd/sd-daemon.h>

#include <chrono>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>

#include "dts/control_client.h"
#include "dts/subscriber.h"
#include "lsl/lab_recorder.h"
#include "lsl/marker_inlets.h"
#include "lsl/outlets.h"
#include "lsl/session_marks.h"
#include "lsl/session_order.h"

namespace dts::lsl {
namespace {

constexpr std::chrono::milliseconds kTurn{100};               // longest delay before a signal is handled
constexpr std::chrono::milliseconds kDevicesTimeout{1000};    // the daemon keeps some seconds of blocks meanwhile
constexpr std::int64_t kInterruptionEveryNs = 1'000'000'000;  // at most one log line for interruptions in this time

core::Error to_core(const client::Error& error) { return {static_cast<core::ErrorCode>(error.code), error.what, error.hint}; }

/// Returns true if SIGTERM or SIGINT has arrived.
bool is_end_asked() {
  sigset_t wanted;
  sigemptyset(&wanted);
  for (const int signal : {SIGTERM, SIGINT}) sigaddset(&wanted, signal);
  const timespec at_once{};
  return sigtimedwait(&wanted, nullptr, &at_once) > 0;
}

/// Passes messages of dtsd to the outlets and to LabRecorder.
class Bridge {
 public:
  Bridge(const Settings& settings, const Liblsl& lsl, client::Subscriber subscriber, client::ControlClient control, core::Clock& clock,
         const core::Log& log)
      : subscriber_(std::move(subscriber)),
        control_(std::move(control)),
        clock_(clock),
        log_(log),
        outlets_(
            settings, lsl, [this] { return control_.devices(); }, clock, log),
        sessions_(settings.rigs) {
    if (settings.lab_recorder) lab_recorder_ = std::make_unique<LabRecorder>(*settings.lab_recorder, log);
  }

  /// Handles messages for at most `kTurn`.
  core::Status serve() {
    const auto message = subscriber_.receive(kTurn);
    if (!message) return tl::make_unexpected(to_core(message.error()));
    note_interruptions();
    if (!*message) return {};
    note_instance();
    if (const auto* block = std::get_if<client::Block>(&**message)) outlets_.take(*block);
    if (const auto* event = std::get_if<client::Event>(&**message)) take(*event);
    if (const auto* restart = std::get_if<client::Restart>(&**message)) take(*restart);
    if (std::holds_alternative<client::Status>(**message)) outlets_.take(*std::get<client::Status>(**message).snapshot);
    return {};
  }

 private:
  /// The status has what the outlets of the first blocks need.
  void note_instance() {
    const v1::StatusSnapshot* const status = subscriber_.status();
    if (status == nullptr || std::exchange(instance_, status->instance_id()) == status->instance_id()) return;
    outlets_.take(*status);
  }
  void note_interruptions() {
    const std::uint64_t interruptions = subscriber_.statistics().interruptions;
    if (interruptions == interruptions_ || clock_.now_ns() < next_interruption_ns_) return;
    next_interruption_ns_ = clock_.now_ns() + kInterruptionEveryNs;
    log_.warning("dtsd ended the connection " + std::to_string(interruptions - std::exchange(interruptions_, interruptions)) +
                 " times: it was restarted, or this machine is too slow. Events may be missing");
  }
  void take(const client::Event& event) {
    outlets_.take(event);
    if (!event.body->has_session()) return;
    sessions_.take(event.rig, event.body->session());
    follow_sessions();
  }
  void take(const client::Restart& restart) {
    log_.info("dtsd was restarted");
    outlets_.take(restart);
    sessions_.clear();
    follow_sessions();
  }
  void follow_sessions() {
    if (lab_recorder_) lab_recorder_->follow(sessions_.first());
  }

  client::Subscriber subscriber_;
  client::ControlClient control_;
  core::Clock& clock_;
  const core::Log& log_;
  Outlets outlets_;
  SessionOrder sessions_;
  std::unique_ptr<LabRecorder> lab_recorder_;
  std::uint64_t instance_ = 0;
  std::uint64_t interruptions_ = 0;
  std::int64_t next_interruption_ns_ = 0;
};

/// The way from LSL to dtsd; nothing if no markers are configured.
struct Inbound {
  std::optional<SessionMarks> marks;
  std::unique_ptr<MarkerInlets> inlets;
};

core::Status open_inbound(const Settings& settings, const client::Endpoints& endpoints, const Liblsl& lsl, const core::Log& log,
                          Inbound& inbound) {
  if (settings.markers_from.empty()) return {};
  DTS_TRY_ASSIGN(inbound.marks, SessionMarks::open(endpoints.control, settings.markers_rig, log));
  const auto handle = [&inbound](const ReceivedMarker& marker, const std::stop_token& stop) { inbound.marks->set(marker, stop); };
  DTS_TRY_ASSIGN(inbound.inlets, MarkerInlets::start(lsl, settings.markers_from, handle, log));
  return {};
}

}  // namespace

core::Status run_bridge(const Settings& settings, const client::Endpoints& endpoints, const Liblsl& lsl, core::Clock& clock,
                        const core::Log& log) {
  auto subscriber = client::Subscriber::open({.endpoint = endpoints.data, .topics = {""}, .key = {}});
  if (!subscriber) return tl::make_unexpected(to_core(subscriber.error()));
  auto control = client::ControlClient::open({.endpoint = endpoints.control, .timeout = kDevicesTimeout, .key = {}});
  if (!control) return tl::make_unexpected(to_core(control.error()));
  Inbound inbound;
  DTS_TRY(open_inbound(settings, endpoints, lsl, log, inbound));
  Bridge bridge(settings, lsl, std::move(*subscriber), std::move(*control), clock, log);
  sd_notify(0, "READY=1");
  const std::int32_t version = lsl.library_version();
  log.info("liblsl " + std::to_string(version / 100) + "." + std::to_string(version % 100) + " is loaded; data of dtsd: " + endpoints.data);
  while (!is_end_asked()) {
    DTS_TRY(bridge.serve());
  }
  sd_notify(0, "STOPPING=1");
  log.info("stopping");
  return {};
}

}  // namespace dts::lsl
