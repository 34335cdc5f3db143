// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/log.h"
#include "record/catalogue/catalogue.h"
#include "session/protocol.h"
#include "session/reach_results.h"
#include "session/recordings.h"
#include "session/rig.h"
#include "session/session.h"
#include "session/sway_results.h"
#include "session/trial_run.h"

namespace dts::session {

/// A position in a rig's data.
struct DataPosition {
  std::uint32_t segment = 0;
  core::ScanIndex scan;
  std::int64_t host_time_ns = 0;
};

/// When something happens, and at which scan: the newest.
struct Moment {
  std::int64_t now_ns = 0;
  std::int64_t utc_minus_monotonic_ns = 0;  ///< By the wall clock at this moment.
  DataPosition at;
};

/// What happened, and at which scan.
struct SessionChange {
  SessionView view;
  DataPosition at;
};
struct TrialChange {
  TrialEvent event;
  DataPosition at;
};

/// A trial was decided.
struct TrialOutcome {
  std::variant<ReachTrialResult, SwayTrialResult> result;
  DataPosition at;
};

enum class TrialAction : std::uint8_t { Next = 1, Redo, Reject };

/// What a session needs besides its rig; outlives it.
struct SessionServices {
  Recordings* recordings = nullptr;  ///< Without: sessions label the stream and write nothing. For tests and benchmarks.
  std::vector<Protocol> protocols{Protocol{}};
  std::string software{};  ///< "dtsd 0.1.0"
  std::string boot_id{};
  /// Returns how many trials the text of a recorded protocol plans: this room reads no files.
  std::function<std::uint32_t(const std::string&)> planned_trials = [](const std::string&) { return 0U; };
};

/// One rig's session with all that belongs to it: its state, its recording, its trials. Thread: control.
class RigSession {
 public:
  RigSession(Rig& rig, SessionServices& services) : rig_(rig), services_(services), session_(rig.config().name) {}

  /// Starts; the recording is safe on the disk when this returns. InvalidArgument: request, protocol or fields; WrongState; or what the
  /// disk says.
  [[nodiscard]] core::Status start(std::string id, const SessionRequest& request, const Moment& moment);
  /// Goes on with an interrupted, incomplete or aborted session of this rig as a further part; trials that count are not repeated.
  [[nodiscard]] core::Status resume(const record::SessionRow& row, const Moment& moment);
  /// Goes to Stopping; `view` says when the recording is closed. An abort is listed as one; `reason` says why it ended in either case.
  [[nodiscard]] core::Status stop(bool is_abort, const std::string& reason, const Moment& moment);
  /// `Next` before the session runs counts as soon as it does. WrongState: no session, none with trials, not running yet, or what TrialRun
  /// says.
  [[nodiscard]] core::Status trial(TrialAction action, const Moment& moment);

  /// Lets time pass; `scans_total` is the rig's counter.
  void tick(const Moment& moment, std::uint64_t scans_total);
  /// The rig's recording ended, for whatever reason.
  void recording_finished(const FinishedRecording& finished, const Moment& moment);
  /// Something happened on the rig: goes to the recording.
  void note(record::RecordedEvent event, const DataPosition& at);

  [[nodiscard]] bool is_under_way() const noexcept { return session_.is_under_way(); }
  [[nodiscard]] SessionView view(std::int64_t now_ns) const { return session_.view(now_ns); }
  /// Nothing when the protocol has no trials.
  [[nodiscard]] std::optional<TrialView> trial_view(std::int64_t now_ns) const;
  /// What happened since the last call, oldest first: it stands in the recording already.
  [[nodiscard]] std::vector<SessionChange> take_changes() { return std::exchange(changes_, {}); }
  [[nodiscard]] std::vector<TrialChange> take_trial_changes() { return std::exchange(trial_changes_, {}); }
  [[nodiscard]] std::vector<TrialOutcome> take_outcomes() { return std::exchange(outcomes_, {}); }

 private:
  [[nodiscard]] core::Result<const Protocol*> find_protocol(const std::string& name) const;
  [[nodiscard]] record::SessionFacts facts(const std::string& id, const SessionRequest& request, const Protocol& protocol,
                                           const Moment& moment) const;
  core::Status begin(const record::SessionFacts& facts, SessionRequest request, const Protocol& protocol,
                     const std::vector<std::uint32_t>& done, const Moment& moment);
  void end_recording(const Moment& moment);
  void collect(const DataPosition& at);
  [[nodiscard]] DataPosition position_at(std::int64_t host_ns, const DataPosition& newest) const;
  void enter_end(const FinishedRecording& finished, std::int64_t now_ns);
  void enter_trial(const TrialEvent& event, const DataPosition& at);
  void put_trial(record::TrialRow& row);
  void give_cue(const TrialEvent& event);
  void prepare_results(const Protocol& protocol, const record::SessionFacts& facts);
  void drain();
  void follow(const DataPosition& at);
  void open_window(const TrialEvent& event, const DataPosition& at);
  void enter_result(record::RecordedEvent event, std::uint32_t trial, std::uint32_t attempt, const DataPosition& at);
  void tell_outcomes(const DataPosition& at);
  void conclude(const DataPosition& at);
  void enter_figures(const std::vector<SessionFigure>& figures, const DataPosition& at);

  Rig& rig_;
  SessionServices& services_;
  Session session_;
  std::optional<TrialRun> trials_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, record::TrialRow> trial_rows_;  ///< By trial and attempt.
  bool is_recording_ = false;
  bool is_aborted_ = false;
  bool is_next_wanted_ = false;  ///< The first trial begins as soon as the session runs.
  std::string end_reason_;
  std::int64_t utc_minus_monotonic_ns_ = 0;  ///< At the start: a clock that is set meanwhile must not end a session before it began.
  std::vector<SessionChange> changes_;
  std::vector<TrialChange> trial_changes_;
  std::optional<ReachResults> reaches_;  ///< Of a session with trials on a rig that finds reaches.
  std::optional<SwayResults> sways_;     ///< The same, on a rig with a centre of pressure.
  TrialPlan plan_;                       ///< Of the session's protocol.
  std::vector<TrialOutcome> outcomes_;
};

}  // namespace dts::session
