// SPDX-License-Identifier: Apache-2.0
#include "session/rig_session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <ranges>

#include "core/join.h"
#include "core/suggest.h"
#include "record/recording.h"
#include "record/sha256.h"
#include "record/utf8_text.h"
#include "session/judges.h"
#include "session/session_events.h"
#include "session/trial_stance.h"

namespace dts::session {
namespace {

using core::ErrorCode;

constexpr std::size_t kLongestReason = 200;
constexpr double kFurthestS = 1.0;                      // maximum time from the newest scan to an event after it
constexpr double kFurthestBackS = kUndoS + kFurthestS;  // the same for an event before it: an undo reports what was due meanwhile

/// FNV-1a: gives the same order of trials for the same session on every machine.
std::uint64_t seed_of(const std::string& id) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : id) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  return hash;
}

/// Returns the duration of all parts of the leading rig without their settling. A part that is not repaired yet counts from its start to
/// the last write to its file.
double recorded_s(const record::SessionRow& row, double settle_s) {
  double sum_s = 0.0;
  for (const record::PartRow& part : row.parts) {
    if (!part.leads()) continue;
    double length_s = part.duration_s;
    std::error_code error;
    const auto written = std::filesystem::last_write_time(part.file, error);
    if (length_s == 0.0 && !error) {
      const auto utc = std::chrono::file_clock::to_sys(written).time_since_epoch();
      length_s = std::chrono::duration<double>(utc).count() - static_cast<double>(part.started_utc_ns) * 1e-9;
    }
    sum_s += std::max(0.0, length_s - settle_s);
  }
  return sum_s;
}

/// Returns the trials of the plan that have begun. Those that are done, or rejected (the plan continued), need no repetition.
std::vector<EarlierTrial> earlier_trials(const record::SessionRow& row, const std::map<std::uint32_t, std::uint32_t>& newest_attempts) {
  std::map<std::uint32_t, const record::TrialRow*> last;
  for (const record::TrialRow& trial : row.trials) {
    const record::TrialRow*& newest = last[trial.trial];
    if (newest == nullptr || trial.part > newest->part || (trial.part == newest->part && trial.attempt > newest->attempt)) newest = &trial;
  }
  std::vector<EarlierTrial> earlier;
  for (const auto& [place, attempt] : newest_attempts) {
    const auto trial = last.find(place);
    const bool is_done = trial != last.end() && (trial->second->outcome == "done" || trial->second->outcome == "rejected");
    earlier.push_back({.trial = place, .newest_attempt = attempt, .is_done = is_done});
  }
  return earlier;
}

}  // namespace

DataPosition position_of(Rig& rig) {
  const AcquisitionReport& report = rig.acquisition();
  return {.segment = report.segment, .scan = {report.next_scan > 0 ? report.next_scan - 1 : 0}, .host_time_ns = report.last_scan_host_ns};
}

core::Result<record::SessionFacts> facts_of(const record::SessionRow& row) {
  core::Result<record::SessionFacts> facts = core::fail(ErrorCode::NotFound, "session " + row.id + " has no recording to continue");
  for (const record::PartRow& part : std::views::reverse(row.parts)) {
    auto read = record::read_session_facts(part.file);
    if (read) return read;
    if (&part == &row.parts.back()) facts = core::fail(read.error().code, part.file + ": " + read.error().what, read.error().hint);
  }
  return facts;
}

std::vector<std::string> rigs_of(const record::SessionRow& row, const core::Result<record::SessionFacts>& facts) {
  return facts && !facts->rigs.empty() ? facts->rigs : record::rigs_of(row);
}

void place(v1::Event& event, const DataPosition& at) {
  event.set_segment(at.segment);
  event.set_scan(at.scan.value);
  if (at.host_time_ns != 0) event.set_host_time_ns(at.host_time_ns);
}

core::Result<const Protocol*> RigSession::find_protocol(const std::string& wanted) const {
  const auto found = std::ranges::find(services_.protocols, wanted, &Protocol::name);
  if (found != services_.protocols.end()) return &*found;
  if (wanted.empty()) return no_protocol();
  std::vector<std::string> known;
  for (const Protocol& protocol : services_.protocols) known.push_back(protocol.name);
  return core::fail(ErrorCode::InvalidArgument, "unknown protocol '" + wanted.substr(0, 64) + "'", core::known_words_hint(wanted, known));
}

/// There is no default: a session with the wrong protocol has no results. The hint names the protocols of this rig.
tl::unexpected<core::Error> RigSession::no_protocol() const {
  const std::string& rig = rig_.config().name;
  std::vector<std::string> known;
  for (const Protocol& protocol : services_.protocols) {
    if (protocol.rig_kind.empty() || protocol.rig_kind == rig_.config().kind) known.push_back(protocol.name);
  }
  std::string hint = "add --protocol NAME, one of: " + core::join(known);
  const auto newest = services_.recordings.catalogue().sessions({.rig = rig, .limit = 1});
  if (newest && !newest->empty()) hint += "; last used on rig '" + rig + "': " + newest->front().protocol;
  return core::fail(ErrorCode::InvalidArgument, "a session needs a protocol, and none is given", hint);
}

record::SessionFacts RigSession::facts(const std::string& id, const SessionRequest& request, const Protocol& protocol,
                                       const Moment& moment) const {
  record::SessionFacts facts{.session_id = id,
                             .part = 1,
                             .protocol = protocol.name,
                             .subject = request.subject,
                             .label = request.label,
                             .fields = request.fields,
                             .duration_s = request.duration_s,
                             .settle_s = request.settle_s};
  facts.utc_minus_monotonic_ns = moment.utc_minus_monotonic_ns;
  facts.started_utc_ns = moment.now_ns + facts.utc_minus_monotonic_ns;
  facts.boot_id = services_.boot_id;
  facts.software = services_.software;
  facts.protocol_definition = protocol.definition;
  facts.plan_seed = seed_of(id);
  set_rig(facts);
  return facts;
}

/// Sets the facts that differ between the rigs of a session.
void RigSession::set_rig(record::SessionFacts& facts) const {
  const pipeline::RigConfig& config = rig_.config();
  const device::DeviceReport report = rig_.device_report();
  facts.rig = config.name;
  facts.kind = config.kind;
  facts.device_uri = config.device_uri;
  device::UnitName unit = device::unit_name(rig_.device(), report);
  facts.device_model = std::move(unit.model);
  facts.device_serial = std::move(unit.serial);
  facts.firmware = report.firmware;
  facts.calibration_id = config.cop_calibration ? config.cop_calibration->id : "";
  facts.stages = rig_.stage_texts();
  facts.rig_definition = config.definition;
  facts.model_sha256 = config.trunk_model_text.empty() ? "" : record::sha256_of(config.trunk_model_text);
}

core::Status RigSession::start(const std::string& id, const SessionRequest& request, const std::vector<RigSession*>& companions,
                               const Moment& moment) {
  DTS_TRY(check(request));
  DTS_TRY(check_subject(services_.label_rule, request.subject));
  DTS_TRY(check_label(services_.label_rule, "label", request.label));
  DTS_TRY_ASSIGN(const auto protocol, find_protocol(request.protocol));
  if (const std::string& kind = protocol->rig_kind; !kind.empty() && kind != rig_.config().kind) {
    return core::fail(ErrorCode::InvalidArgument, "protocol '" + protocol->name + "' is for a " + kind + ", and rig '" +
                                                      rig_.config().name + "' is a " + rig_.config().kind);
  }
  DTS_TRY(check_fields(*protocol, request.fields));
  return begin(facts(id, request, *protocol, moment), request, *protocol, {}, companions, moment);
}

core::Status RigSession::resume(const record::SessionRow& row, const record::SessionFacts& earlier,
                                const std::vector<RigSession*>& companions, const Moment& moment) {
  DTS_TRY_ASSIGN(const auto protocol, find_protocol(earlier.protocol));
  if (protocol->definition != earlier.protocol_definition) {
    return core::fail(ErrorCode::WrongState, "protocol '" + earlier.protocol + "' has changed since session " + row.id + " began",
                      "start a new session");
  }
  SessionRequest request{.protocol = earlier.protocol,
                         .subject = earlier.subject,
                         .label = row.label,  // perhaps a person removed the recorded one
                         .settle_s = earlier.settle_s,
                         .fields = earlier.fields};
  DTS_TRY(check(request));
  DTS_TRY(check_fields(*protocol, request.fields));
  DTS_TRY_ASSIGN(const auto attempts, services_.recordings.catalogue().newest_attempts(row.id));
  const std::vector<EarlierTrial> begun = earlier_trials(row, attempts);
  const auto done = static_cast<std::size_t>(std::ranges::count(begun, true, &EarlierTrial::is_done));
  const std::size_t planned = protocol->trials ? make_plan(*protocol->trials, earlier.plan_seed).size() : 0;
  // Without trials, only a message shows a session that ended early.
  if (row.state == "complete" && done >= planned && (planned > 0 || row.message.empty())) {
    const std::string trials = planned > 0 ? "all " + std::to_string(planned) + " trials are done, " : "";
    return core::fail(ErrorCode::WrongState, "session " + row.id + " is complete: " + trials + "there is nothing to resume",
                      "start a new session: dtsctl session start --rig " + row.rig + " --protocol NAME");
  }
  // The requested duration, or the protocol's, less what is already recorded.
  if (const double whole_s = earlier.duration_s > 0.0 ? earlier.duration_s : protocol->duration_s; whole_s > 0.0) {
    request.duration_s = whole_s - recorded_s(row, earlier.settle_s > 0.0 ? earlier.settle_s : protocol->settle_s);
    if (request.duration_s < 1.0) {
      return core::fail(ErrorCode::WrongState, "session " + row.id + " has less than 1 s left: there is nothing to resume",
                        "start a new one");
    }
  }
  record::SessionFacts next = facts(row.id, request, *protocol, moment);
  next.duration_s = earlier.duration_s;
  next.plan_seed = earlier.plan_seed;
  next.part = row.parts.back().part + 1;
  return begin(next, request, *protocol, begun, companions, moment);
}

core::Status RigSession::begin(record::SessionFacts facts, SessionRequest request, const Protocol& protocol,
                               const std::vector<EarlierTrial>& earlier, const std::vector<RigSession*>& companions, const Moment& moment) {
  if (request.settle_s == 0.0) request.settle_s = protocol.settle_s;
  if (request.duration_s == 0.0) request.duration_s = protocol.duration_s;
  std::vector<RigSession*> all{this};
  all.insert(all.end(), companions.begin(), companions.end());
  if (!companions.empty()) {
    for (const RigSession* one : all) facts.rigs.push_back(one->rig());
  }
  std::vector<RecordingStart> starts;
  for (RigSession* one : all) {
    DTS_TRY(one->session_.check_free());
    starts.push_back({.rig = one->rig_, .facts = facts});
    if (one == this) continue;
    one->set_rig(starts.back().facts);
    starts.back().facts.part = facts.part + static_cast<std::uint32_t>(starts.size() - 1);
    starts.back().facts.leading_part = facts.part;
  }
  // Before the recording, which begins with the state of the stages.
  for (RigSession* one : all) one->rig_.stances().begin(stance_width_mm(facts.fields));
  if (const auto begun = services_.recordings.begin(starts); !begun) {
    for (RigSession* one : all) one->rig_.stances().begin(0.0);
    return begun;
  }
  enter(facts, protocol, nullptr, moment.now_ns);
  companions_ = companions;
  if (protocol.trials) trials_.emplace(*protocol.trials, facts.plan_seed, facts.fields, earlier);
  judges_ = protocol.trials ? make_judges(rig_, facts, services_.software, services_.worker) : decltype(judges_){};
  auto started = session_.start(facts.session_id, request, moment.now_ns);
  collect(moment.at);
  request.duration_s = 0.0;  // the leading rig stops all
  for (std::size_t index = 1; index < all.size(); ++index) {
    all[index]->enter(starts[index].facts, protocol, this, moment.now_ns);
    static_cast<void>(all[index]->session_.start(facts.session_id, request, moment.now_ns));  // cannot fail: it is free
    all[index]->collect(position_of(all[index]->rig_));
  }
  return started;
}

/// Prepares this rig for a session whose recording has begun. Skips the frames from before the session.
void RigSession::enter(const record::SessionFacts& facts, const Protocol& protocol, RigSession* leader, std::int64_t now_ns) {
  is_recording_ = true;
  began_ns_ = now_ns;
  is_aborted_ = false;
  is_next_wanted_ = false;
  end_reason_.clear();
  incomplete_.clear();
  lost_rigs_.clear();
  has_ended_ = false;
  utc_minus_monotonic_ns_ = facts.utc_minus_monotonic_ns;
  trials_entered_.clear();
  markers_ = 0;
  trials_.reset();
  judges_.clear();
  rigs_ = facts.rigs;
  leader_ = leader;
  companions_.clear();
  if (protocol.trials) plan_ = *protocol.trials;
  drain();
  rig_.windows().restart();
}

core::Status RigSession::stop(bool is_abort, const std::string& reason, const Moment& moment) {
  DTS_TRY(session_.stop(moment.now_ns));
  is_aborted_ = is_abort;
  end_reason_ = reason.substr(0, kLongestReason);
  end_trials(moment);
  return {};
}

void RigSession::end_trials(const Moment& moment) {
  is_next_wanted_ = false;
  if (trials_) trials_->abort(moment.now_ns);
  stop_companions(moment);
  collect(moment.at);
  follow(moment.at);
  for (const auto& judge : judges_) judge->finish();
  if (is_recording_) {
    // In case the daemon ends before the file is closed: this session was not interrupted and must not be resumed automatically.
    services_.recordings.end_session(session_.view(moment.now_ns).id, is_aborted_ ? "aborted" : "incomplete",
                                     is_aborted_ ? end_reason_ : "it was stopped, and its recording was being closed",
                                     moment.now_ns + utc_minus_monotonic_ns_);
  }
  is_awaiting_results_ = true;
  end_recording_if_judged(moment);
}

/// Adds everything up to now to the recording and ends it, as soon as the result of each trial is known.
void RigSession::end_recording_if_judged(const Moment& moment) {
  if (!is_awaiting_results_ || is_analysing()) return;
  is_awaiting_results_ = false;
  conclude(moment.at);
  end_recording(moment);
  for (RigSession* companion : companions_)
    companion->end_recording(
        {.now_ns = moment.now_ns, .utc_minus_monotonic_ns = moment.utc_minus_monotonic_ns, .at = position_of(companion->rig_)});
}

/// Ends the recording of this rig, if that was not done before.
void RigSession::end_recording(const Moment& moment) {
  if (std::exchange(has_ended_, true)) return;
  if (is_aborted_) {  // in the recording too, because the catalogue may be rebuilt from it
    v1::Event aborted = to_event(session_.view(moment.now_ns));
    aborted.mutable_session()->set_is_aborted(true);
    aborted.mutable_session()->clear_state();  // it has been recorded
    aborted.mutable_session()->set_message(record::clean_text(end_reason_));
    note(std::move(aborted), moment.at);
  }
  services_.recordings.end(rig_);
}

void RigSession::wait_for_results(const Moment& moment) {
  for (const auto& judge : judges_) judge->wait();
  end_recording_if_judged(moment);
}

core::Status RigSession::trial(TrialAction action, const Moment& moment) {
  const SessionState state = session_.view(moment.now_ns).state;
  if (!trials_ || !session_.is_under_way()) {
    return core::fail(ErrorCode::WrongState, "rig '" + rig_.config().name + "' has no session with trials",
                      "start one: dtsctl session start --rig " + rig_.config().name + " --protocol NAME; see dtsctl protocol list");
  }
  const bool is_about_to_run = state == SessionState::Starting || state == SessionState::Settling;
  if (is_about_to_run && action == TrialAction::Next) {
    is_next_wanted_ = true;
    return {};
  }
  if (state != SessionState::Running) {
    return core::fail(ErrorCode::WrongState, "the session is " + std::string(name(state)) + ", not running", "wait for it: dtsctl status");
  }
  core::Status done = core::fail(ErrorCode::InvalidArgument, "unknown trial action");
  switch (action) {
    case TrialAction::Next: done = trials_->next(moment.now_ns); break;
    case TrialAction::Redo: done = trials_->redo(moment.now_ns); break;
    case TrialAction::Reject: done = trials_->reject(moment.now_ns); break;
    case TrialAction::Undo: done = trials_->undo(moment.now_ns); break;
  }
  collect(moment.at);
  return done;
}

SessionView RigSession::view(std::int64_t now_ns) const {
  SessionView view = session_.view(now_ns);
  view.rigs = rigs_;
  if (is_companion()) {
    const SessionView leading = leader_->session_.view(now_ns);
    if (view.message.empty()) view.message = leading.message;
    view.request.duration_s = leading.request.duration_s;
  }
  return view;
}

std::optional<TrialView> RigSession::trial_view(std::int64_t now_ns) const {
  if (is_companion()) return leader_->trial_view(now_ns);
  if (!trials_) return std::nullopt;
  TrialView view = trials_->view(now_ns);
  view.is_next_wanted = is_next_wanted_;
  if (view.last_ended && view.last_ended->outcome == TrialEventKind::Done) {
    const auto known = trials_entered_.find({view.last_ended->trial, view.last_ended->attempt});
    if (known != trials_entered_.end()) view.last_ended->fault = known->second.fault;
  }
  return view;
}

void RigSession::tick(const Moment& moment, std::uint64_t scans_total) {
  const bool was_stopping = session_.view(moment.now_ns).state == SessionState::Stopping;
  session_.tick(moment.now_ns, scans_total);
  const SessionState state = session_.view(moment.now_ns).state;
  if (trials_ && state == SessionState::Running) {
    trials_->tick(moment.now_ns);
    if (std::exchange(is_next_wanted_, false)) static_cast<void>(trials_->next(moment.now_ns));  // the plan is waiting for its first trial
  }
  report_lost(moment.now_ns);
  collect(moment.at);
  follow(moment.at);
  if (!was_stopping && state == SessionState::Stopping) return is_companion() ? end_recording(moment) : end_trials(moment);
  end_recording_if_judged(moment);
}

void RigSession::recording_finished(const FinishedRecording& finished, const Moment& moment) {
  is_recording_ = false;
  rig_.stances().begin(0.0);  // the next person may stand differently
  if (is_companion()) return leave(finished, moment);
  note_incomplete(rig(), finished);
  if (session_.is_under_way() && session_.view(moment.now_ns).state != SessionState::Stopping) {
    session_.fail(moment.now_ns, "the recording stopped: " + finished.incomplete);  // a session must be recorded
    end_trials(moment);
  }
  wait_for_results(moment);  // rare: the recording failed while an analysis runs
  close_if_all_ended(moment);
}

void RigSession::revise(const record::SessionRow& row, const Moment& moment) {
  if (session_.view(moment.now_ns).id != row.id) return;
  session_.revise(row.subject, row.label, moment.now_ns);
  collect(moment.at);
}

void RigSession::forget(const std::string& subject, const Moment& moment) {
  if (is_under_way() || session_.view(moment.now_ns).request.subject != subject) return;
  session_.forget(moment.now_ns);
  services_.recordings.forget(rig_.config().name);
  trials_.reset();
  rigs_.clear();
  collect(moment.at);
}

/// Writes an event of the session to the recording, and keeps it for the bus.
void RigSession::publish(v1::Event event, const DataPosition& at) {
  place(event, at);
  note(event, at);
  events_.push_back(std::move(event));
}

void RigSession::mark(const std::string& text, const DataPosition& at) {
  if (!is_recording_) return;
  note(marker_event(text), at);
  if (is_companion()) return;
  services_.recordings.enter_marker({.session_id = session_.view(0).id,
                                     .part = services_.recordings.part(rig_.config().name),
                                     .number = ++markers_,
                                     .segment = at.segment,
                                     .scan = at.scan.value,
                                     .text = text});
}

void RigSession::note(v1::Event event, const DataPosition& at) {
  if (!is_recording_) return;
  place(event, at);
  if (event.has_session()) {  // both are in the file's header; exports of the events must not name them
    event.mutable_session()->clear_subject();
    event.mutable_session()->clear_label();
  }
  services_.recordings.note(rig_.config().name, std::move(event));
}

/// Writes the changes of the state machines to the recording and the catalogue, and keeps them for the bus.
void RigSession::collect(const DataPosition& at) {
  for (const SessionView& change : session_.take_changes()) publish(to_event(change), at);
  if (!trials_) return;
  for (const TrialEvent& event : trials_->take_events()) {
    const DataPosition due = position_at(event.at_ns, at);
    take_step(event, due);
    enter_trial(event, due);
    for (const auto& judge : judges_) judge->take(event, due.segment, due.scan);
    for (RigSession* companion : companions_) {
      companion->take_step(event, companion->position_at(event.at_ns, position_of(companion->rig_)));
    }
  }
}

/// Executes a step of a trial on this rig: in its recording, on the bus, in its stages, and for its simulated subject.
void RigSession::take_step(const TrialEvent& event, const DataPosition& at) {
  publish(to_event(event, session_.view(0).id), at);
  open_window(event, at);
  announce_feet(rig_.stances(), event, at.segment, at.scan, rig_.config().rate);
  give_cue(event);
}

DataPosition RigSession::position_at(std::int64_t host_ns, const DataPosition& newest) const {
  const double after_s = static_cast<double>(host_ns - newest.host_time_ns) * 1e-9;
  if (newest.host_time_ns == 0 || after_s > kFurthestS || after_s < -kFurthestBackS) return newest;  // no scans for some time
  const double scans = std::round(after_s * rig_.config().rate.hz());
  const double scan = static_cast<double>(newest.scan.value) + scans;
  return {.segment = newest.segment, .scan = {static_cast<std::uint64_t>(std::max(scan, 0.0))}, .host_time_ns = host_ns};
}

void RigSession::enter_trial(const TrialEvent& event, const DataPosition& at) {
  EnteredTrial& entered = trials_entered_[{event.trial, event.attempt}];
  record::TrialRow& row = entered.row;
  switch (event.kind) {
    case TrialEventKind::Ready: services_.recordings.enter_attempt(session_.view(0).id, event.trial, event.attempt); [[fallthrough]];
    case TrialEventKind::Go:
    case TrialEventKind::Measure:
      row.trial = event.trial;
      row.attempt = event.attempt;
      row.block = event.block;
      row.condition = event.condition;
      row.segment = at.segment;
      row.first_scan = at.scan.value;
      return;
    case TrialEventKind::Rest:
    case TrialEventKind::Finished: return;
    case TrialEventKind::Undone:
      if (!entered.is_done) services_.recordings.remove_trial(row);
      if (entered.withheld) events_.push_back(*std::exchange(entered.withheld, std::nullopt));
      row.outcome = entered.is_done ? name(TrialEventKind::Done) : "";
      return put_trial(row);
    case TrialEventKind::Done: entered.is_done = true; [[fallthrough]];
    case TrialEventKind::Redone:
    case TrialEventKind::Rejected:
    case TrialEventKind::Aborted: break;
  }
  if (row.outcome.empty()) {  // a trial that is voided after its end keeps its end
    row.last_segment = at.segment;
    row.last_scan = at.scan.value;
  }
  row.outcome = name(event.kind);
  put_trial(row);
}

void RigSession::put_trial(record::TrialRow& row) {
  if (row.outcome.empty()) return;  // a trial under way is entered when it ends
  row.session_id = session_.view(0).id;
  row.part = services_.recordings.part(rig_.config().name);
  services_.recordings.enter_trial(row);
}

void RigSession::enter_end(std::int64_t now_ns) {
  const SessionView view = session_.view(now_ns);
  std::string state = incomplete_.empty() ? "complete" : "incomplete";
  std::string message = incomplete_.empty() ? view.message : incomplete_;
  if (message.empty() && !lost_rigs_.empty()) {
    message = (lost_rigs_.size() == 1 ? "rig " : "rigs ") + core::join(lost_rigs_) + " delivered nothing for a time; the gaps show when";
  }
  if (is_aborted_) state = "aborted";
  if (!end_reason_.empty()) message = end_reason_;
  services_.recordings.end_session(view.id, state, message, now_ns + utc_minus_monotonic_ns_);
}

}  // namespace dts::session
