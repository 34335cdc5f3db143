// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/log.h"
#include "device/found_units.h"
#include "session/correction_request.h"
#include "session/rig.h"
#include "session/rig_session.h"
#include "session/subject_edit.h"

namespace dts::session {

struct DeviceTest {
  Rig* rig = nullptr;
  StatisticsReport statistics;  ///< Of the last second; has no scans if there is a problem.
  device::DeviceReport report;
  std::string problem;  ///< Why the device is not streaming; empty while it streams.
};

/// Where a marker is on one rig.
struct PlacedMark {
  std::string rig;
  DataPosition at;
  bool is_before_session = false;  ///< Its time is before the session that is under way: it is published, but not recorded.
};

/// An event from the control thread to the bus.
struct Notice {
  std::string rig;
  v1::Event event;
};

/// The state of one rig for status answers. References are valid until the supervisor's next call.
struct RigState {
  Rig& rig;
  AcquisitionReport acquisition;
  PipelineReport pipeline;
  pipeline::TareReport tare;
  SessionView session;
  RecordingView recording;
  std::uint32_t part = 0;  ///< Of the current or last recording.
  std::optional<TrialView> trial;
  double measured_rate_hz = 0.0;  ///< Scans per host second over the last seconds; 0 until known.
  RingFill ring_fill;
  PublishReport published;
  std::string sensor_problems{};  ///< See Rig::sensor_problems.
};

/// Owns the rigs and their sessions and executes commands on them. Thread: control, all of it.
class Supervisor {
 public:
  /// `usb` (nullptr: none) and the recordings in `services` must outlive the supervisor.
  Supervisor(core::Clock& clock, core::Log log, device::usb::UsbBus* usb, SessionServices services)
      : clock_(clock), log_(std::move(log)), usb_(usb), services_(std::move(services)) {}

  ~Supervisor() { services_.recordings.stop(); }  // its thread reads from the rigs
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// Adds a rig and owns it. Fails with InvalidArgument if the name is used already.
  [[nodiscard]] core::Status add(std::unique_ptr<Rig> rig);
  void start();
  /// Stops all sessions, closes their recordings and stops all rigs.
  void stop();

  [[nodiscard]] std::vector<RigState> states();
  [[nodiscard]] std::vector<Rig*> rigs();
  /// Returns what can make results wrong although everything runs, each with what to do: a calibration that was measured with another
  /// device, and a wall clock that is behind the newest session.
  [[nodiscard]] std::vector<std::string> warnings() const;
  /// Starts a session on a rig, and on `companions`: see RigSession. If a rig cannot start, none does.
  [[nodiscard]] core::Result<SessionView> start_session(const std::string& rig, const SessionRequest& request,
                                                        const std::vector<std::string>& companions = {});
  /// Continues a session of the catalogue as a new part on each of its rigs. Fails if one of them is missing.
  [[nodiscard]] core::Result<std::pair<std::string, SessionView>> resume_session(const std::string& id);
  /// Resumes the sessions that a crash interrupted, if configured. Retries for up to a minute while this can still succeed. Call it once,
  /// after `start`.
  void resume_interrupted();
  /// Stops the session of a rig. An empty rig name means the only session. The session ends later, when its recording is closed: see
  /// `session`.
  [[nodiscard]] core::Result<std::pair<std::string, SessionView>> stop_session(const std::string& rig, bool is_abort = false,
                                                                               const std::string& reason = {});
  [[nodiscard]] core::Result<SessionView> session(const std::string& rig);
  /// Executes a step of a session with trials. An empty rig name means the only session.
  [[nodiscard]] core::Result<TrialView> trial(const std::string& rig, TrialAction action);
  [[nodiscard]] const std::vector<Protocol>& protocols() const noexcept { return services_.protocols; }
  [[nodiscard]] const LabelRule& label_rule() const noexcept { return services_.label_rule; }
  /// Returns the number of trials planned in a session of the catalogue; 0: its protocol has none.
  [[nodiscard]] std::uint32_t planned_trials(const record::SessionRow& session) const {
    return services_.planned_trials(session.protocol_definition);
  }
  [[nodiscard]] Recordings& recordings() noexcept { return services_.recordings; }
  // supervisor_edit.cpp
  /// Corrects a closed session and returns it. `who`: for the correction, as in the audit trail. Fails like `corrections_for` and
  /// `Recordings::closed_session`, and with WrongState for a deleted session.
  [[nodiscard]] core::Result<record::SessionRow> correct_session(const CorrectionRequest& request, const std::string& who);
  /// Deletes a closed session (hides it from lists), or restores it, and returns it. Fails with WrongState if it is deleted already, or
  /// not.
  [[nodiscard]] core::Result<record::SessionRow> delete_session(const std::string& id, const std::string& reason, bool is_restore,
                                                                const std::string& who);
  /// Adds or removes a note or a planned session of a subject. Fails like `edited`, and with NotFound if nothing has this subject ID.
  [[nodiscard]] core::Status edit_subject(const SubjectEdit& edit, const std::string& who);
  /// Begins to erase a subject: see `Recordings::begin_erasure`.
  [[nodiscard]] core::Status erase_subject(const std::string& subject, const std::string& who);

  /// Sets a marker in one rig and the other rigs of its session, or in every rig for an empty name: at the newest scan, or at the time
  /// `host_ns`. A marker from before a session is published, but no recording of that session has it. Fails with InvalidArgument if the
  /// time is more than 5 s before now or 1 s after it.
  [[nodiscard]] core::Result<std::vector<PlacedMark>> mark(const std::string& rig, const std::string& text,
                                                           std::optional<std::int64_t> host_ns = {});
  /// Requests a tare. Fails with WrongState during a session, because the recorded values would change their meaning. The tare is done when
  /// `RigState::tare.request` equals the returned number and the outcome is no longer Running.
  [[nodiscard]] core::Result<std::uint64_t> tare(const std::string& rig);
  /// Cancels a tare whose client no longer waits.
  void cancel_tare(const std::string& rig, std::uint64_t request);
  [[nodiscard]] core::Result<pipeline::TareReport> tare_report(const std::string& rig);
  /// Returns statistics and report of a rig's device. If the device is not streaming, returns its failed checks, or
  /// fails with DeviceGone if there are none. Fails with WrongState if it has streamed for less than 1 s.
  [[nodiscard]] core::Result<DeviceTest> test_device(const std::string& rig);

  /// Returns USB devices that the daemon can drive and that no rig uses or waits for.
  [[nodiscard]] core::Result<std::vector<device::FoundUnit>> unused_units();
  /// Returns serial ports of USB devices that no rig uses or waits for.
  [[nodiscard]] std::vector<device::FoundPort> unused_ports();
  /// Returns one line per kind of device that the daemon can drive.
  [[nodiscard]] static std::vector<std::string> device_kinds();

  /// Advances sessions and devices; call it about 20 times per second.
  void tick();
  /// Returns the notices since the last call, oldest first.
  [[nodiscard]] std::vector<Notice> take_notices();

 private:
  struct Entry {
    std::unique_ptr<Rig> rig;
    RigSession session;
    device::DeviceState reported_state = device::DeviceState::Closed;
    std::string reported_message{};
    std::vector<std::string> calibration_warnings{};  ///< See `session::calibration_warnings`, of the unit that streamed last.
    std::int64_t calibration_checked_day = 0;         ///< UTC days since 1970.
    std::uint64_t reported_gaps = 0;
    bool has_pulse_due = false;      ///< A sync pulse follows: at the first scan of a session, and at `next_pulse_ns` in a pulse train.
    bool has_pulse_failed = false;   ///< The newest sync pulse could not be sent, and this was reported.
    std::int64_t next_pulse_ns = 0;  ///< 0: the first pulse of a session.
    std::int64_t rate_since_ns = 0;
    std::uint64_t rate_since_scans = 0;
    double measured_rate_hz = 0.0;
    std::int64_t sync_low_at_ns = 0;  ///< End of the sync pulse; 0: no pulse.
    std::uint64_t tare_request = 0;   ///< The newest request that was not cancelled.
  };
  [[nodiscard]] core::Result<Entry*> find(const std::string& name);
  /// Returns the rigs with these names. Fails with NotFound, and with InvalidArgument if one is named twice.
  [[nodiscard]] core::Result<std::vector<Entry*>> find_all(const std::vector<std::string>& names);
  /// Returns the rig that leads the session of the rig with this name, or for an empty name that of the only session.
  [[nodiscard]] core::Result<Entry*> find_with_session(const std::string& name);
  [[nodiscard]] Moment moment(Entry& entry) {
    return {.now_ns = clock_.now_ns(), .utc_minus_monotonic_ns = clock_.utc_minus_monotonic_ns(), .at = position_of(*entry.rig)};
  }
  [[nodiscard]] core::Result<record::SessionRow> corrected_session(const record::SessionRow& session,
                                                                   std::vector<record::Correction> corrections, const std::string& who);
  [[nodiscard]] core::Result<SessionView> begun(const std::vector<Entry*>& entries, const core::Status& status);
  /// Keeps an event for the bus.
  void report_event(const std::string& rig, const DataPosition& at, v1::Event event);
  void finish_recordings();
  void log_gaps(Entry& entry, const AcquisitionReport& report);
  void collect_session_changes(Entry& entry);
  void begin_sync_pulse(Entry& entry, std::int64_t now_ns);
  void end_sync_pulse(Entry& entry, std::int64_t now_ns);
  void notice_device_change(Entry& entry, const AcquisitionReport& report);
  void check_calibration(Entry& entry, const AcquisitionReport& report);
  /// Removes the notes of a subject that has neither entries nor sessions any more: a wrong subject ID must not stay in the list.
  void forget_empty_notes(const std::string& subject);
  /// Reads the newest session of the catalogue, for `clock_warning`.
  void find_newest_session();
  /// Returns a warning if the wall clock is earlier than the begin of the newest session; else nothing.
  [[nodiscard]] std::string clock_warning() const;
  [[nodiscard]] std::int64_t now_utc_ns() const { return clock_.now_ns() + clock_.utc_minus_monotonic_ns(); }
  void measure_rate(Entry& entry, const AcquisitionReport& report, std::int64_t now_ns);
  [[nodiscard]] std::string new_session_id(const std::string& rig);
  [[nodiscard]] static core::Status check_startable(Entry& entry);
  [[nodiscard]] static core::Status check_startable(const std::vector<Entry*>& entries);
  void try_resumes(std::int64_t now_ns);
  /// Stops resuming on this rig, because a person decided what runs on it.
  void forget_resumable(const std::string& rig);
  [[nodiscard]] bool waits_for_device(const std::string& session_id, std::int64_t now_ns);

  core::Clock& clock_;
  core::Log log_;
  device::usb::UsbBus* usb_;
  SessionServices services_;
  std::map<std::string, Entry, std::less<>> entries_;
  std::vector<Notice> notices_;
  std::uint32_t sessions_started_ = 0;
  std::string newest_session_;  ///< Its ID; empty: the catalogue has none.
  std::int64_t newest_started_utc_ns_ = 0;
  std::vector<std::string> resumable_;
  std::int64_t resume_until_ns_ = 0;
  std::int64_t next_resume_ns_ = 0;
};

}  // namespace dts::session
