// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/clock.h"
#include "core/log.h"
#include "device/found_units.h"
#include "session/rig.h"
#include "session/rig_session.h"

namespace dts::session {

struct DeviceTest {
  Rig* rig = nullptr;
  StatisticsReport statistics;  ///< Of the last second; no scans when there is a problem.
  device::DeviceReport report;
  std::string problem;  ///< Why it is not streaming; empty: it is.
};

struct MarkerNotice {
  std::string text;
};
struct DeviceNotice {
  device::DeviceState state = device::DeviceState::Closed;
  std::string uri;
  std::string message;
};

struct TrialNotice {
  std::string session_id;
  TrialEvent event;
};

struct TrialResultNotice {
  std::string session_id;
  ReachTrialResult result;
};

struct SwayNotice {
  std::string session_id;
  std::string software;  ///< Who computed it.
  SwayTrialResult result;
};

/// Something that the control thread has to tell the bus.
struct Notice {
  std::string rig;
  DataPosition at;
  std::variant<MarkerNotice, DeviceNotice, SessionView, TrialNotice, TrialResultNotice, SwayNotice> body;
};

/// The state of one rig for status answers; references live as long as the supervisor and until its next call.
struct RigState {
  Rig& rig;
  AcquisitionReport acquisition;
  PipelineReport pipeline;
  pipeline::TareReport tare;
  SessionView session;
  RecordingView recording;
  std::uint32_t part = 0;  ///< Of the recording under way, or of the last.
  std::optional<TrialView> trial;
  double measured_rate_hz = 0.0;  ///< Scans per host second over the last seconds; 0 until known.
  RingFill ring_fill;
  LatencyReport latency;
  std::string sensor_problems{};  ///< Which sensors did not measure in the last second; empty: none.
};

/// Owns the rigs and their sessions and executes commands on them. Thread: control, all of it.
class Supervisor {
 public:
  /// `usb` (nullptr: none) and the recordings of `services` outlive the supervisor.
  Supervisor(core::Clock& clock, core::Log log, device::usb::UsbBus* usb = nullptr, SessionServices services = {})
      : clock_(clock), log_(std::move(log)), usb_(usb), services_(std::move(services)) {}

  ~Supervisor() {
    if (services_.recordings != nullptr) services_.recordings->stop();  // its thread reads from the rigs
  }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Takes a rig over; names must differ.
  [[nodiscard]] core::Status add(std::unique_ptr<Rig> rig);
  void start();
  /// Ends all sessions properly and stops all rigs.
  void stop();

  [[nodiscard]] std::vector<RigState> states();
  [[nodiscard]] std::vector<Rig*> rigs();
  [[nodiscard]] core::Result<SessionView> start_session(const std::string& rig, const SessionRequest& request);
  /// Goes on with a session of the catalogue as a new part.
  [[nodiscard]] core::Result<std::pair<std::string, SessionView>> resume_session(const std::string& id);
  /// Goes on with what a crash interrupted, if the configuration says so: tried until it succeeds or the time that it gives has passed.
  /// Call it once, after `start`.
  void resume_interrupted();
  /// An empty name means the only rig that has a session. It is over when `session` says so: the recording is being closed.
  [[nodiscard]] core::Result<std::pair<std::string, SessionView>> stop_session(const std::string& rig, bool is_abort = false,
                                                                               const std::string& reason = {});
  [[nodiscard]] core::Result<SessionView> session(const std::string& rig);
  /// A step of a session with trials; an empty name as above.
  [[nodiscard]] core::Result<TrialView> trial(const std::string& rig, TrialAction action);
  [[nodiscard]] const std::vector<Protocol>& protocols() const noexcept { return services_.protocols; }
  /// Of a session of the catalogue; 0: its protocol plans none.
  [[nodiscard]] std::uint32_t planned_trials(const record::SessionRow& session) const {
    return services_.planned_trials(session.protocol_definition);
  }
  /// nullptr: nothing is recorded.
  [[nodiscard]] Recordings* recordings() noexcept { return services_.recordings; }
  /// Marks the newest scan of one rig, or of every rig for an empty name.
  [[nodiscard]] core::Result<std::vector<std::pair<std::string, DataPosition>>> mark(const std::string& rig, const std::string& text);
  /// Asks for a tare (WrongState during a session: what it recorded so far would mean something else); compare the number with
  /// `RigState::tare.request` to see when it is answered.
  [[nodiscard]] core::Result<std::uint64_t> tare(const std::string& rig);
  /// Withdraws a tare that nobody waits for any more.
  void cancel_tare(const std::string& rig, std::uint64_t request);
  [[nodiscard]] core::Result<pipeline::TareReport> tare_report(const std::string& rig);
  /// What is known of a rig's device. WrongState: it has never been opened, or streams for less than a second.
  [[nodiscard]] core::Result<DeviceTest> test_device(const std::string& rig);

  /// Units on USB that this program could drive and that no rig uses or waits for.
  [[nodiscard]] core::Result<std::vector<device::FoundUnit>> unused_units();
  /// One line per device kind that this program can drive.
  [[nodiscard]] static std::vector<std::string> device_kinds();

  /// Lets sessions and devices move on; call it about 20 times per second.
  void tick();
  /// What happened since the last call, oldest first.
  [[nodiscard]] std::vector<Notice> take_notices();

 private:
  struct Entry {
    std::unique_ptr<Rig> rig;
    RigSession session;
    device::DeviceState told_state = device::DeviceState::Closed;
    std::string told_message{};
    std::uint64_t told_gaps = 0;
    bool has_pulse_due = false;  ///< A session has started and does not run yet.
    std::int64_t rate_since_ns = 0;
    std::uint64_t rate_since_scans = 0;
    double measured_rate_hz = 0.0;
    std::int64_t sync_low_at_ns = 0;  ///< When the sync pulse ends; 0: none under way.
    std::uint64_t tare_request = 0;   ///< The newest that was not withdrawn.
  };
  [[nodiscard]] core::Result<Entry*> find(const std::string& name);
  /// The rig named, or for an empty name the only one with a session.
  [[nodiscard]] core::Result<Entry*> find_with_session(const std::string& name);
  [[nodiscard]] static DataPosition position(Entry& entry);
  [[nodiscard]] Moment moment(Entry& entry) {
    return {.now_ns = clock_.now_ns(), .utc_minus_monotonic_ns = clock_.utc_minus_monotonic_ns(), .at = position(entry)};
  }
  [[nodiscard]] core::Result<SessionView> begun(Entry& entry, const core::Status& status);
  void finish_recordings();
  void log_gaps(Entry& entry, const AcquisitionReport& report);
  void collect_session_changes(Entry& entry);
  void begin_sync_pulse(Entry& entry, std::int64_t now_ns);
  void end_sync_pulse(Entry& entry, std::int64_t now_ns);
  void notice_device_change(Entry& entry, const AcquisitionReport& report);
  void measure_rate(Entry& entry, const AcquisitionReport& report, std::int64_t now_ns);
  [[nodiscard]] std::string new_session_id(const std::string& rig);
  [[nodiscard]] static core::Status check_startable(Entry& entry);
  void try_resumes(std::int64_t now_ns);
  /// Somebody decided what happens on this rig now.
  void forget_resumable(const std::string& rig);
  [[nodiscard]] bool waits_for_device(const std::string& session_id, std::int64_t now_ns);

  core::Clock& clock_;
  core::Log log_;
  device::usb::UsbBus* usb_;
  SessionServices services_;
  std::map<std::string, Entry, std::less<>> entries_;
  std::vector<Notice> notices_;
  std::uint32_t sessions_started_ = 0;
  std::vector<std::string> resumable_;
  std::int64_t resume_until_ns_ = 0;
  std::int64_t next_resume_ns_ = 0;
};

}  // namespace dts::session
