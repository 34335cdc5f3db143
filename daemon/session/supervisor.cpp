// SPDX-License-Identifier: Apache-2.0
#include "session/supervisor.h"

#include <ctime>

#include <algorithm>
#include <array>
#include <chrono>
#include <limits>
#include <utility>

#include "core/suggest.h"
#include "core/utc_text.h"
#include "device/registry.h"
#include "session/calibration_check.h"
#include "session/device_state_name.h"
#include "session/session_events.h"

namespace dts::session {
namespace {

constexpr std::int64_t kRateWindowNs = 2'000'000'000;
constexpr std::size_t kLongestMark = 200;
constexpr std::int64_t kOldestMarkNs = 5 * core::kNanosecondsPerSecond;  // before now: marker programs need time, too
constexpr std::int64_t kNewestMarkNs = core::kNanosecondsPerSecond;      // after now: clocks of two machines differ
constexpr std::chrono::seconds kCloseLimit{10};                          // if the disk hangs longer, the next start recovers the recordings

constexpr std::int64_t kDayNs = 86'400 * core::kNanosecondsPerSecond;
constexpr std::int64_t kClockToleranceNs = 60 * core::kNanosecondsPerSecond;  // NTP may set a clock back by seconds
constexpr std::size_t kUtcMinutes = 16;                                       // "2026-11-21T14:45"

}  // namespace

core::Status Supervisor::add(std::unique_ptr<Rig> rig) {
  const std::string rig_name = rig->config().name;
  Rig& added = *rig;
  const bool is_new = entries_.try_emplace(rig_name, Entry{.rig = std::move(rig), .session = RigSession(added, services_)}).second;
  if (!is_new) return core::fail(core::ErrorCode::InvalidArgument, "two rigs are named '" + rig_name + "'", "rename one");
  services_.recordings.add(added);
  return {};
}

void Supervisor::start() {
  services_.recordings.start();
  find_newest_session();
  for (auto& [rig_name, entry] : entries_) {
    entry.rig->start(log_);
    log_.info("rig '" + rig_name + "': " + entry.rig->device().model + " (" + entry.rig->config().device_uri + ")");
  }
}

void Supervisor::stop() {
  for (auto& [rig_name, entry] : entries_) {
    if (entry.session.is_under_way() && !entry.session.is_companion())
      static_cast<void>(entry.session.stop(false, "the daemon was stopped", moment(entry)));  // fails only if it is stopping already
    entry.session.wait_for_results(moment(entry));
  }
  services_.recordings.wait_until_closed(kCloseLimit);
  services_.recordings.stop();
  finish_recordings();
  for (auto& [rig_name, entry] : entries_) {
    collect_session_changes(entry);
    end_sync_pulse(entry, std::numeric_limits<std::int64_t>::max());
    entry.rig->stop();
  }
}

std::vector<RigState> Supervisor::states() {
  std::vector<RigState> states;
  for (auto& [rig_name, entry] : entries_) {
    states.push_back({.rig = *entry.rig,
                      .acquisition = entry.rig->acquisition(),
                      .pipeline = entry.rig->pipeline_report(),
                      .tare = entry.rig->tare().latest(),
                      .session = entry.session.view(clock_.now_ns()),
                      .recording = services_.recordings.view(rig_name),
                      .part = services_.recordings.part(rig_name),
                      .trial = entry.session.trial_view(clock_.now_ns()),
                      .measured_rate_hz = entry.measured_rate_hz,
                      .ring_fill = entry.rig->ring_fill(),
                      .published = entry.rig->published(),
                      .sensor_problems = entry.rig->sensor_problems()});
  }
  return states;
}

std::vector<Rig*> Supervisor::rigs() {
  std::vector<Rig*> rigs;
  for (auto& [rig_name, entry] : entries_) rigs.push_back(entry.rig.get());
  return rigs;
}

core::Result<Supervisor::Entry*> Supervisor::find(const std::string& name) {
  if (const auto found = entries_.find(name); found != entries_.end()) return &found->second;
  std::vector<std::string> known;
  for (const auto& [rig_name, entry] : entries_) known.push_back(rig_name);
  return core::fail(core::ErrorCode::NotFound, "no rig named '" + name.substr(0, kLongestMark) + "'", core::known_words_hint(name, known));
}

std::vector<std::string> Supervisor::warnings() const {
  std::vector<std::string> warnings;
  if (std::string warning = clock_warning(); !warning.empty()) warnings.push_back(std::move(warning));
  for (const auto& [rig_name, entry] : entries_) {
    warnings.insert(warnings.end(), entry.calibration_warnings.begin(), entry.calibration_warnings.end());
  }
  return warnings;
}

void Supervisor::find_newest_session() {
  const auto newest = services_.recordings.catalogue().sessions({.limit = 1});
  const bool has_session = newest && !newest->empty();
  newest_session_ = has_session ? newest->front().id : "";
  newest_started_utc_ns_ = has_session ? newest->front().started_utc_ns : 0;
}

std::string Supervisor::clock_warning() const {
  if (newest_session_.empty() || newest_started_utc_ns_ <= now_utc_ns() + kClockToleranceNs) return {};
  return "the clock of this machine says " + core::utc_text(now_utc_ns()).substr(0, kUtcMinutes) + " UTC, and session " + newest_session_ +
         " began later, at " + core::utc_text(newest_started_utc_ns_).substr(0, kUtcMinutes) +
         " UTC: visits would be in the wrong order; set the clock (timedatectl), or delete that session if its date is the wrong one";
}

std::string Supervisor::new_session_id(const std::string& rig) {
  const std::time_t now_s = now_utc_ns() / 1'000'000'000;
  std::tm utc{};
  gmtime_r(&now_s, &utc);
  std::array<char, 32> stamp{};
  std::strftime(stamp.data(), stamp.size(), "%Y%m%dT%H%M%SZ", &utc);
  const auto id = [&] { return std::string(stamp.data()) + "-" + rig + "-" + std::to_string(sessions_started_ + 1); };
  // The ID may exist already: the daemon was restarted in the same second, or after the clock was set back.
  while (services_.recordings.catalogue().session(id())) ++sessions_started_;
  return id();
}

/// Accepts a device that is just being opened, but rejects one that is known to be away: the subject would have come for nothing. Rejects a
/// start while a tare is under way, because it would take effect during the recording and change the meaning of its values, also for a
/// replay.
core::Status Supervisor::check_startable(Entry& entry) {
  const std::string where = "rig '" + entry.rig->config().name + "' ";
  const AcquisitionReport& acquisition = entry.rig->acquisition();
  if (acquisition.device != device::DeviceState::Streaming && !acquisition.text().empty()) {
    return core::fail(core::ErrorCode::WrongState, where + "delivers nothing: " + std::string(acquisition.text()),
                      "fix this first: dtsctl status");
  }
  const pipeline::TareReport& tare = entry.rig->tare().latest();
  const bool is_taring = tare.request < entry.tare_request || tare.outcome == pipeline::TareOutcome::Running;
  if (entry.tare_request == 0 || !is_taring) return {};
  return core::fail(core::ErrorCode::WrongState, where + "is being tared", "wait until the tare ends");
}

/// Several rigs begin together, so each of them must deliver scans already.
core::Status Supervisor::check_startable(const std::vector<Entry*>& entries) {
  for (Entry* entry : entries) {
    DTS_TRY(check_startable(*entry));
    const AcquisitionReport& acquisition = entry->rig->acquisition();
    if (entries.size() == 1 || (acquisition.delivers() && acquisition.scans_total > 0)) continue;
    return core::fail(core::ErrorCode::WrongState, "rig '" + entry->rig->config().name + "' delivers no scans yet",
                      "wait for its device: dtsctl status");
  }
  return {};
}

core::Result<SessionView> Supervisor::begun(const std::vector<Entry*>& entries, const core::Status& status) {
  if (!status) return tl::make_unexpected(status.error());
  const SessionView view = entries.front()->session.view(clock_.now_ns());
  for (Entry* entry : entries) {
    entry->has_pulse_due = entry->rig->config().sync_pulse_ms > 0.0;
    entry->has_pulse_failed = false;
    entry->next_pulse_ns = 0;
    forget_resumable(entry->rig->config().name);
    log_.info("session " + view.id + " starts on rig '" + entry->rig->config().name + "'");
    collect_session_changes(*entry);
  }
  return view;
}

namespace {

/// Returns the sessions of all but the first, which leads.
template <class Entry>
std::vector<RigSession*> companions_in(const std::vector<Entry*>& entries) {
  std::vector<RigSession*> companions;
  for (std::size_t index = 1; index < entries.size(); ++index) companions.push_back(&entries[index]->session);
  return companions;
}

}  // namespace

core::Result<SessionView> Supervisor::start_session(const std::string& rig, const SessionRequest& request,
                                                    const std::vector<std::string>& companions) {
  std::vector<std::string> names{rig};
  names.insert(names.end(), companions.begin(), companions.end());
  DTS_TRY_ASSIGN(const auto entries, find_all(names));
  DTS_TRY(check_startable(entries));
  Entry& leading = *entries.front();
  if (const std::string warning = clock_warning(); !warning.empty()) log_.warning(warning);
  auto started = leading.session.start(new_session_id(rig), request, companions_in(entries), moment(leading));
  if (started) {
    ++sessions_started_;
    find_newest_session();
  }
  return begun(entries, started);
}

core::Result<std::pair<std::string, SessionView>> Supervisor::resume_session(const std::string& id) {
  DTS_TRY_ASSIGN(const auto row, services_.recordings.catalogue().session(id));
  if (row.is_deleted || row.subject != row.recorded_subject) {  // each part has the recorded subject ID
    return core::fail(core::ErrorCode::WrongState, "session " + row.id + (row.is_deleted ? " is deleted" : " has a corrected subject ID"),
                      row.is_deleted ? "restore it first: dtsctl session restore " + row.id
                                     : "start a new session: dtsctl session start --rig " + row.rig);
  }
  DTS_TRY_ASSIGN(const auto earlier, facts_of(row));
  DTS_TRY_ASSIGN(const auto entries, find_all(rigs_of(row, earlier)));
  DTS_TRY(check_startable(entries));
  Entry& leading = *entries.front();
  DTS_TRY_ASSIGN(auto view, begun(entries, leading.session.resume(row, earlier, companions_in(entries), moment(leading))));
  return std::pair{row.rig, view};
}

core::Result<std::vector<Supervisor::Entry*>> Supervisor::find_all(const std::vector<std::string>& names) {
  std::vector<Entry*> entries;
  for (const std::string& name : names) {
    DTS_TRY_ASSIGN(auto entry, find(name));
    if (std::ranges::find(entries, entry) != entries.end()) {
      return core::fail(core::ErrorCode::InvalidArgument, "rig '" + name + "' is given twice");
    }
    entries.push_back(entry);
  }
  return entries;
}

core::Result<Supervisor::Entry*> Supervisor::find_with_session(const std::string& name) {
  if (!name.empty()) {
    DTS_TRY_ASSIGN(auto entry, find(name));
    return find(entry->session.leading().rig());
  }
  Entry* only = nullptr;
  std::string rigs;
  for (auto& [rig_name, entry] : entries_) {
    if (!entry.session.is_under_way() || entry.session.is_companion()) continue;
    rigs += (rigs.empty() ? "" : " or --rig ") + rig_name;
    only = rigs == rig_name ? &entry : nullptr;
  }
  if (only == nullptr && !rigs.empty()) {
    return core::fail(core::ErrorCode::InvalidArgument, "several sessions are under way", "choose one: --rig " + rigs);
  }
  if (only == nullptr) return core::fail(core::ErrorCode::WrongState, "no rig has a session");
  return only;
}

core::Result<std::pair<std::string, SessionView>> Supervisor::stop_session(const std::string& rig, bool is_abort,
                                                                           const std::string& reason) {
  DTS_TRY_ASSIGN(auto entry, find_with_session(rig));
  DTS_TRY(entry->session.stop(is_abort, reason, moment(*entry)));
  const SessionView view = entry->session.view(clock_.now_ns());
  log_.info("session " + view.id + (is_abort ? " is aborted" : " stops"));
  collect_session_changes(*entry);
  return std::pair{entry->rig->config().name, view};
}

core::Result<SessionView> Supervisor::session(const std::string& rig) {
  DTS_TRY_ASSIGN(auto entry, find(rig));
  return entry->session.view(clock_.now_ns());
}

core::Result<TrialView> Supervisor::trial(const std::string& rig, TrialAction action) {
  DTS_TRY_ASSIGN(auto entry, find_with_session(rig));
  auto done = entry->session.trial(action, moment(*entry));
  collect_session_changes(*entry);
  if (!done) return tl::make_unexpected(done.error());
  return entry->session.trial_view(clock_.now_ns()).value_or(TrialView{});
}

/// Ends the sessions whose recordings have ended.
void Supervisor::finish_recordings() {
  for (const FinishedRecording& finished : services_.recordings.take_finished()) {
    auto entry = find(finished.rig);
    if (entry) (*entry)->session.recording_finished(finished, moment(**entry));
  }
}

core::Result<std::vector<PlacedMark>> Supervisor::mark(const std::string& rig, const std::string& text,
                                                       std::optional<std::int64_t> host_ns) {
  if (text.empty() || text.size() > kLongestMark) {
    return core::fail(core::ErrorCode::InvalidArgument, "a marker's text has 1..200 bytes, this one " + std::to_string(text.size()));
  }
  DTS_TRY(check_label(services_.label_rule, "marker", text));
  if (const std::int64_t now_ns = clock_.now_ns(); host_ns && (*host_ns < now_ns - kOldestMarkNs || *host_ns > now_ns + kNewestMarkNs)) {
    return core::fail(core::ErrorCode::InvalidArgument, "a marker's time is 5 s before now to 1 s after it, this one is not",
                      "send the marker at once, with a time of this machine's CLOCK_MONOTONIC");
  }
  std::vector<Entry*> chosen;
  if (rig.empty()) {
    for (auto& [rig_name, entry] : entries_) chosen.push_back(&entry);
  } else {
    DTS_TRY_ASSIGN(auto entry, find_with_session(rig));
    std::vector<std::string> names{entry->rig->config().name};
    for (const RigSession* companion : entry->session.companions()) names.push_back(companion->rig());
    DTS_TRY_ASSIGN(chosen, find_all(names));
  }
  std::vector<PlacedMark> marks;
  for (Entry* entry : chosen) {
    const AcquisitionReport& report = entry->rig->acquisition();
    const bool has_scans = report.device == device::DeviceState::Streaming && report.scans_total > 0;
    // All recordings of a session have the same markers, so that their numbers agree.
    const bool is_of_several = entry->session.is_under_way() && !entry->session.view(0).rigs.empty();
    if (!has_scans && !is_of_several) {
      if (rig.empty()) continue;
      return core::fail(core::ErrorCode::WrongState, "rig '" + rig + "' delivers no scans to mark", "see dtsctl status");
    }
    const DataPosition newest = position_of(*entry->rig);
    marks.push_back({.rig = entry->rig->config().name,
                     .at = host_ns ? entry->session.position_at(*host_ns, newest) : newest,
                     .is_before_session = host_ns && entry->session.began_after(*host_ns)});
  }
  if (marks.empty()) return core::fail(core::ErrorCode::WrongState, "no rig delivers scans to mark", "see dtsctl status");
  for (const PlacedMark& mark : marks) {
    report_event(mark.rig, mark.at, marker_event(text));
    if (!mark.is_before_session) find(mark.rig).value()->session.mark(text, mark.at);
  }
  return marks;
}

core::Result<std::uint64_t> Supervisor::tare(const std::string& rig) {
  DTS_TRY_ASSIGN(auto entry, find(rig));
  if (entry->rig->acquisition().device != device::DeviceState::Streaming) {
    return core::fail(core::ErrorCode::WrongState, "rig '" + rig + "' is not streaming", "see dtsctl status");
  }
  if (entry->session.is_under_way()) {
    return core::fail(core::ErrorCode::WrongState, "rig '" + rig + "' has a session: a tare would change the meaning of its results",
                      "tare before the next session, or stop this one first: dtsctl session stop --rig " + rig);
  }
  const auto formats = entry->rig->formats();
  const auto is_tared = [](const core::StreamFormat& format) { return format.name == "deflection" || format.name == "force"; };
  if (std::ranges::none_of(formats, is_tared)) {
    return core::fail(core::ErrorCode::Unsupported, "rig '" + rig + "' has no stage that tares",
                      "add [[stage]] id = \"linearise\" to its file, or \"force_plate\" for a force plate");
  }
  return entry->tare_request = entry->rig->tare().request();
}

void Supervisor::cancel_tare(const std::string& rig, std::uint64_t request) {
  const auto entry = find(rig);
  if (!entry) return;
  (*entry)->rig->tare().cancel(request);
  if ((*entry)->tare_request == request) (*entry)->tare_request = 0;
}

core::Result<pipeline::TareReport> Supervisor::tare_report(const std::string& rig) {
  DTS_TRY_ASSIGN(auto entry, find(rig));
  return entry->rig->tare().latest();
}

void Supervisor::tick() {
  const std::int64_t now_ns = clock_.now_ns();
  finish_recordings();
  try_resumes(now_ns);
  for (auto& [rig_name, entry] : entries_) {
    const AcquisitionReport report = entry.rig->acquisition();
    measure_rate(entry, report, now_ns);
    check_calibration(entry, report);
    notice_device_change(entry, report);
    log_gaps(entry, report);
    end_sync_pulse(entry, now_ns);
    entry.session.tick(moment(entry), report.scans_total);
    begin_sync_pulse(entry, now_ns);
    collect_session_changes(entry);
  }
}

/// Logs every gap, even one that ended between two calls.
void Supervisor::log_gaps(Entry& entry, const AcquisitionReport& report) {
  const std::uint64_t fresh = report.losses.total().gaps - entry.reported_gaps;
  if (fresh == 0) return;
  entry.reported_gaps = report.losses.total().gaps;
  const std::string more = fresh > 1 ? " (and " + std::to_string(fresh - 1) + " more gaps before it)" : "";
  log_.warning("rig '" + entry.rig->config().name + "': " + (report.last_gap.is_exact ? "" : "about ") +
               std::to_string(report.last_gap.missing_scans) + " scans missing before segment " + std::to_string(report.segment) + ", " +
               std::string(core::name(report.last_gap.reason)) + (report.gap_text().empty() ? "" : ": ") + std::string(report.gap_text()) +
               more);
}

std::vector<Notice> Supervisor::take_notices() { return std::exchange(notices_, {}); }

void Supervisor::report_event(const std::string& rig, const DataPosition& at, v1::Event event) {
  place(event, at);
  notices_.push_back({.rig = rig, .event = std::move(event)});
}

void Supervisor::collect_session_changes(Entry& entry) {
  const std::string& rig = entry.rig->config().name;
  for (v1::Event& event : entry.session.take_events()) notices_.push_back({.rig = rig, .event = std::move(event)});
}

void Supervisor::notice_device_change(Entry& entry, const AcquisitionReport& report) {
  if (report.device == entry.reported_state && report.text() == entry.reported_message) return;
  entry.reported_state = report.device;
  entry.reported_message = report.text();
  const std::string line = "rig '" + entry.rig->config().name + "': device " + std::string(name(report.device)) +
                           (entry.reported_message.empty() ? "" : ": " + entry.reported_message);
  if (entry.reported_message.empty()) {
    log_.info(line);
  } else {
    log_.warning(line);
  }
  const v1::Event event = device_event(report.device, entry.rig->config().device_uri, entry.reported_message);
  report_event(entry.rig->config().name, position_of(*entry.rig), event);
  entry.session.note(event, position_of(*entry.rig));
}

/// When the device begins to stream, because another unit may have been plugged in while it was away; and each day, because a calibration
/// becomes old.
void Supervisor::check_calibration(Entry& entry, const AcquisitionReport& report) {
  if (report.device != device::DeviceState::Streaming) return;
  const std::int64_t today = now_utc_ns() / kDayNs;
  if (report.device == entry.reported_state && today == entry.calibration_checked_day) return;
  entry.calibration_checked_day = today;
  auto warnings = calibration_warnings(entry.rig->config(), entry.rig->device(), entry.rig->device_report(), now_utc_ns());
  for (const std::string& warning : warnings) {
    if (std::ranges::find(entry.calibration_warnings, warning) == entry.calibration_warnings.end()) log_.warning(warning);
  }
  entry.calibration_warnings = std::move(warnings);
}

void Supervisor::measure_rate(Entry& entry, const AcquisitionReport& report, std::int64_t now_ns) {
  if (now_ns - report.last_scan_host_ns > kRateWindowNs) {
    entry.measured_rate_hz = 0.0;
    entry.rate_since_ns = 0;
    return;
  }
  const std::int64_t window_ns = report.last_scan_host_ns - entry.rate_since_ns;
  if (entry.rate_since_ns != 0 && window_ns < kRateWindowNs) return;
  if (entry.rate_since_ns != 0) {
    entry.measured_rate_hz = static_cast<double>(report.scans_total - entry.rate_since_scans) / (static_cast<double>(window_ns) * 1e-9);
  }
  entry.rate_since_ns = report.last_scan_host_ns;
  entry.rate_since_scans = report.scans_total;
}

}  // namespace dts::session
