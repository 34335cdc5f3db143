// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/log.h"
#include "core/worker.h"
#include "record/catalogue/catalogue.h"
#include "session/label_rule.h"
#include "session/protocol.h"
#include "session/recordings.h"
#include "session/rig.h"
#include "session/session.h"
#include "session/trial_judge.h"
#include "session/trial_run.h"

namespace dts::session {

/// A position in a rig's data.
struct DataPosition {
  std::uint32_t segment = 0;
  core::ScanIndex scan;
  std::int64_t host_time_ns = 0;
};

/// Returns the position of the newest scan of a rig.
[[nodiscard]] DataPosition position_of(Rig& rig);
/// Writes the position of an event into it. The host time is unknown before the first scan.
void place(v1::Event& event, const DataPosition& at);

/// The current time and the newest scan.
struct Moment {
  std::int64_t now_ns = 0;
  std::int64_t utc_minus_monotonic_ns = 0;  ///< By the wall clock at this time.
  DataPosition at;
};

enum class TrialAction : std::uint8_t { Next = 1, Redo, Reject, Undo };

/// What a session needs besides its rig; must outlive the session.
struct SessionServices {
  Recordings& recordings;
  core::Worker& worker;  ///< Analyses finished trials.
  std::vector<Protocol> protocols{Protocol{}};
  LabelRule label_rule{};
  std::string software{};  ///< "dtsd 0.1.0"
  std::string boot_id{};
  /// Folder that holds sys/ and dev/, where `device list` looks for serial ports; empty: the machine's own; nothing: it does not look.
  std::optional<std::string> ports_root{};
  /// Returns the number of trials in a recorded protocol's text. A function, because this folder reads no files.
  std::function<std::uint32_t(const std::string&)> planned_trials = [](const std::string&) { return 0U; };
};

/// Returns the facts of a session from its newest readable recording; all of them agree on what a resumed session needs.
[[nodiscard]] core::Result<record::SessionFacts> facts_of(const record::SessionRow& row);

/// Returns the rigs of a session, the leading one first, also those on which no recording began. `facts`: see `facts_of`; without them,
/// only the rigs that have recordings are known.
[[nodiscard]] std::vector<std::string> rigs_of(const record::SessionRow& row, const core::Result<record::SessionFacts>& facts);

/// One rig's session: its state, its recording and its trials. Thread: control.
///
/// A session over several rigs has a RigSession for each. One of them leads: it has the trials, their results and the end of the session.
/// The others are its companions: they record at the same time, with the steps of the same trials at their own scans, and end with it.
/// Commands go to the leading one. A companion whose recording fails leaves the session, which continues; if the recording of the leading
/// rig fails, the session fails, because the results are those of its recording. A device that is away ends nothing.
class RigSession {
 public:
  RigSession(Rig& rig, SessionServices& services)
      : rig_(rig), services_(services), frames_(rig.frames(), rig.frames().capacity()), session_(rig.config().name) {}

  /// Starts a session; its recording is safe on the disk when this returns. Fails with InvalidArgument (request, no protocol or an unknown
  /// one, fields), WrongState, or the error of the recording. After an error, no rig records.
  [[nodiscard]] core::Status start(const std::string& id, const SessionRequest& request, const std::vector<RigSession*>& companions,
                                   const Moment& moment);
  /// Continues an interrupted, incomplete or aborted session that this rig led, with new parts; valid trials are not repeated. `earlier`:
  /// see `facts_of`.
  [[nodiscard]] core::Status resume(const record::SessionRow& row, const record::SessionFacts& earlier,
                                    const std::vector<RigSession*>& companions, const Moment& moment);
  /// Enters Stopping; the recording ends when the results of the last trials are known and written, and `view` shows when it is closed. The
  /// catalogue lists an abort as aborted, and in both cases `reason`.
  [[nodiscard]] core::Status stop(bool is_abort, const std::string& reason, const Moment& moment);
  /// Executes `action`. `Next` before the session runs is done as soon as it runs. Fails with WrongState if there is no session, it has no
  /// trials or does not run yet, or if TrialRun rejects the action.
  [[nodiscard]] core::Status trial(TrialAction action, const Moment& moment);

  /// Advances the session to `moment`; `scans_total` is the rig's counter.
  void tick(const Moment& moment, std::uint64_t scans_total);
  /// Waits for the results of the last trials of a session that is stopping, so that its recording ends. For the end of the daemon.
  void wait_for_results(const Moment& moment);
  /// Ends the session if the rig's recording ended for any reason.
  void recording_finished(const FinishedRecording& finished, const Moment& moment);
  /// Writes a marker to the recording, and if this rig leads, to the catalogue.
  void mark(const std::string& text, const DataPosition& at);
  /// Returns whether a session is under way whose recording began after this time.
  [[nodiscard]] bool began_after(std::int64_t host_ns) const noexcept { return is_recording_ && host_ns < began_ns_; }
  /// Writes an event of the rig to the recording.
  void note(v1::Event event, const DataPosition& at);

  /// Returns the position of `host_ns`, calculated back from the newest scan with the exact rate: so phases have their exact length, even
  /// if they are detected late. A time before this segment is placed at its first scan, because a gap has no scans, and
  /// stays as it is. Returns `newest` for a time more than 6 s before it or 1 s after it.
  [[nodiscard]] DataPosition position_at(std::int64_t host_ns, const DataPosition& newest) const;

  /// Takes over the corrected subject ID and label if this is the last session.
  void revise(const record::SessionRow& row, const Moment& moment);
  /// Forgets the last session if it was one of this subject.
  void forget(const std::string& subject, const Moment& moment);

  [[nodiscard]] const std::string& rig() const noexcept { return rig_.config().name; }
  [[nodiscard]] bool is_under_way() const noexcept { return session_.is_under_way(); }
  [[nodiscard]] bool is_companion() const noexcept { return leader_ != nullptr; }
  /// Returns who leads the session under way: this or the one whose companion it is.
  [[nodiscard]] RigSession& leading() noexcept { return is_companion() ? *leader_ : *this; }
  [[nodiscard]] const std::vector<RigSession*>& companions() const noexcept { return companions_; }
  [[nodiscard]] SessionView view(std::int64_t now_ns) const;
  /// Returns the trials of the session, also for a companion; nothing if the protocol has none.
  [[nodiscard]] std::optional<TrialView> trial_view(std::int64_t now_ns) const;
  /// Returns the events to publish since the last call, oldest first: changes of the session, steps and results of its trials. They are
  /// already in the recording, unless it has failed.
  [[nodiscard]] std::vector<v1::Event> take_events() { return std::exchange(events_, {}); }

 private:
  [[nodiscard]] core::Result<const Protocol*> find_protocol(const std::string& name) const;
  [[nodiscard]] tl::unexpected<core::Error> no_protocol() const;
  [[nodiscard]] record::SessionFacts facts(const std::string& id, const SessionRequest& request, const Protocol& protocol,
                                           const Moment& moment) const;
  void set_rig(record::SessionFacts& facts) const;
  core::Status begin(record::SessionFacts facts, SessionRequest request, const Protocol& protocol, const std::vector<EarlierTrial>& earlier,
                     const std::vector<RigSession*>& companions, const Moment& moment);
  void enter(const record::SessionFacts& facts, const Protocol& protocol, RigSession* leader, std::int64_t now_ns);
  void take_step(const TrialEvent& event, const DataPosition& at);
  void stop_companions(const Moment& moment);
  void end_recording(const Moment& moment);
  void leave(const FinishedRecording& finished, const Moment& moment);
  void close_if_all_ended(const Moment& moment);
  void report_lost(std::int64_t now_ns);
  void note_incomplete(const std::string& rig, const FinishedRecording& finished);
  void end_trials(const Moment& moment);
  void end_recording_if_judged(const Moment& moment);
  void collect(const DataPosition& at);
  void enter_end(std::int64_t now_ns);
  void enter_trial(const TrialEvent& event, const DataPosition& at);
  void put_trial(record::TrialRow& row);
  void give_cue(const TrialEvent& event);
  [[nodiscard]] bool is_analysing() const;
  void drain();
  void follow(const DataPosition& at);
  void open_window(const TrialEvent& event, const DataPosition& at);
  void enter_result(TrialResultEvent& result, const DataPosition& at);
  void enter_results(const DataPosition& at);
  void publish(v1::Event event, const DataPosition& at);
  void conclude(const DataPosition& at);
  void enter_figures(const std::vector<SessionFigure>& figures, const DataPosition& at);

  Rig& rig_;
  SessionServices& services_;
  core::FrameReader frames_;
  Session session_;
  std::optional<TrialRun> trials_;
  /// An attempt as the catalogue knows it.
  struct EnteredTrial {
    record::TrialRow row{};
    bool is_done = false;                 ///< Also if it was redone or rejected later.
    std::optional<v1::Event> withheld{};  ///< Its result, which was known while it was void: for the bus, if that is undone.
    v1::TrialFault fault = v1::TRIAL_FAULT_UNSPECIFIED;
  };
  std::map<std::pair<std::uint32_t, std::uint32_t>, EnteredTrial> trials_entered_;  ///< By trial and attempt.
  std::vector<std::string> rigs_;        ///< Of a session over several rigs, the leading one first; empty: one rig.
  RigSession* leader_ = nullptr;         ///< Of a companion in a session under way; the supervisor owns both.
  std::vector<RigSession*> companions_;  ///< Those that still record.
  std::string incomplete_;               ///< Why a recording of the session that has ended is not complete; empty: all are.
  std::vector<std::string> lost_rigs_;   ///< Rigs of the session that delivered nothing for a time.
  std::uint32_t markers_ = 0;            ///< In the recording of this part.
  bool is_recording_ = false;
  std::int64_t began_ns_ = 0;         ///< When this part of the session began.
  bool has_ended_ = false;            ///< The end of the recording was ordered.
  bool is_awaiting_results_ = false;  ///< The trials have ended; the recording ends when their results are known.
  bool is_aborted_ = false;
  bool is_next_wanted_ = false;  ///< Start the first trial as soon as the session runs.
  std::string end_reason_;
  std::int64_t utc_minus_monotonic_ns_ = 0;          ///< At the start: a clock set during the session must not make it end before it began.
  std::vector<v1::Event> events_;                    ///< To publish.
  std::vector<std::unique_ptr<TrialJudge>> judges_;  ///< None: the session has no trials.
  TrialPlan plan_;                                   ///< From the session's protocol.
};

}  // namespace dts::session
