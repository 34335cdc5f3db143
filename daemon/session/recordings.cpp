// SPDX-License-Identifier: Apache-2.0
#include "session/recordings.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "record/xdf/recovery.h"
#include "session/rig_pipeline.h"
#include "session/set_aside.h"

namespace dts::session {
namespace {

constexpr double kScalarBytes = 8.0;

std::vector<record::RecordedStream> streams_of(const Rig& rig) { return recorded_streams(rig.config(), rig.device(), rig.formats()); }

double bytes_per_second(const Rig& rig) {
  double sum = 0.0;
  for (const record::RecordedStream& stream : streams_of(rig)) {
    const double bytes = stream.info.value_type == record::ValueType::Float32 ? kScalarBytes / 2.0 : kScalarBytes;
    sum += stream.info.rate->hz() * static_cast<double>(stream.info.channels.size()) * bytes;
  }
  return sum;
}

std::string file_of(const StorageConfig& config, const record::SessionFacts& facts) {
  const std::string part = facts.part > 1 ? "." + std::to_string(facts.part) : "";
  return sessions_directory(config) + "/" + facts.session_id + part + ".xdf";
}

/// Returns the closed recording of a part if the daemon ended between closing the file and updating the catalogue.
std::optional<record::FoundRecording> closed_already(const record::PartRow& part) {
  const std::string closed = part.file.substr(0, part.file.rfind(".part"));
  std::error_code unknown;
  if (std::filesystem::exists(part.file, unknown) || !std::filesystem::exists(closed, unknown)) return std::nullopt;
  auto found = record::read_recording(closed);
  if (!found || found->part.session_id != part.session_id || found->part.part != part.part) return std::nullopt;
  if (found->part.state != record::PartState::Complete && found->part.state != record::PartState::Incomplete) return std::nullopt;
  return *found;
}

/// Returns the end time of the data in a closed or repaired part. A damaged file may contain any duration; an impossible one counts as 0.
std::int64_t end_of_data_utc_ns(const record::PartRow& part) {
  constexpr double kLongest_s = 1e8;  // three years
  const bool is_possible = part.duration_s >= 0.0 && part.duration_s <= kLongest_s;
  return part.started_utc_ns + (is_possible ? static_cast<std::int64_t>(part.duration_s * 1e9) : 0);
}

/// How a session ended.
struct ShownEnd {
  std::string state = "complete";
  std::string message;
  std::int64_t utc_ns = 0;
};

/// Returns the end of a session as its newest parts show it.
ShownEnd end_shown_by(const std::vector<record::PartRow>& newest) {
  ShownEnd end;
  for (const record::PartRow& part : newest) {
    const bool is_closed = part.state == record::PartState::Complete || part.state == record::PartState::Incomplete;
    end.state = record::worse_state(end.state, is_closed ? std::string(record::name(part.state)) : "interrupted");
    if (end.message.empty()) end.message = part.reason;
    end.utc_ns = std::max(end.utc_ns, end_of_data_utc_ns(part));
  }
  return end;
}

}  // namespace

core::Result<std::unique_ptr<Recordings>> Recordings::open_catalogue(const StorageConfig& config, core::Clock& clock,
                                                                     const core::Log& log) {
  DTS_TRY_ASSIGN(auto catalogue, record::Catalogue::open(catalogue_file(config)));
  std::unique_ptr<Recordings> recordings(new Recordings(config, clock, log, std::move(catalogue)));
  recordings->continue_erasure();  // first, so that no file of an erased session is entered again
  DTS_TRY(recordings->enter_interrupted());
  return recordings;
}

core::Result<std::unique_ptr<Recordings>> Recordings::open(const StorageConfig& config, core::Clock& clock, core::Log log) {
  DTS_TRY(prepare_storage(config));
  const std::string file = catalogue_file(config);
  std::string damage = is_half_set_aside(file) ? file + " is missing, but files that belong to it exist" : "";
  core::Result<std::unique_ptr<Recordings>> opened;
  if (damage.empty()) opened = open_catalogue(config, clock, log);
  if (!opened && opened.error().code == core::ErrorCode::DataDamaged) damage = opened.error().what;
  if (!damage.empty()) {
    DTS_TRY_ASSIGN(const auto aside, set_aside(file, clock.now_ns() + clock.utc_minus_monotonic_ns()));
    opened = open_catalogue(config, clock, log);
    if (!opened) return opened;
    (*opened)->notice_ = damage + "; dtsd kept it as " + aside + " and rebuilt the catalogue from the recordings, except the audit trail";
    (*opened)->audit("catalogue_rebuilt", aside, "ok");
  }
  if (!opened) return opened;
  std::unique_ptr<Recordings> recordings = std::move(*opened);
  // A damaged audit trail does not stop the measurements, but must appear in the log without a request.
  if (auto sound = recordings->catalogue_->verify_audit(); !sound) recordings->log_.error(core::to_string(sound.error()));
  return recordings;
}

/// Enters parts that were being written when the last daemon ended, and unknown files in the folder.
core::Status Recordings::enter_interrupted() {
  DTS_TRY_ASSIGN(auto unfinished, catalogue_->unfinished_parts());
  for (record::PartRow& part : unfinished) {
    if (const auto closed = closed_already(part); closed && enter(*closed)) continue;
    part.state = record::PartState::Interrupted;
    part.reason = "the daemon or the power failed during the recording";
    DTS_TRY(catalogue_->update_part(part));
  }
  DTS_TRY_ASSIGN(const auto rebuilt, record::rebuild(*catalogue_, sessions_directory(config_)));
  for (const std::string& problem : rebuilt.unreadable) log_.warning("cannot enter a recording into the catalogue: " + problem);
  if (rebuilt.added > 0) log_.info(std::to_string(rebuilt.added) + " recordings entered into the catalogue");
  sum_up_corrected();  // the last daemon may have ended between corrections and results
  end_continued_erasure();
  if (rebuilt.read_again > 0) log_.info(std::to_string(rebuilt.read_again) + " recordings read again for what the catalogue lacked");
  DTS_TRY_ASSIGN(auto sessions, catalogue_->sessions({.limit = 10'000, .shown = record::Shown::Both}));
  for (record::SessionRow& session : sessions) end_left_running(session);
  find_resumable(sessions);
  DTS_TRY_ASSIGN(auto parts, catalogue_->parts());
  std::ranges::copy_if(parts, std::back_inserter(interrupted_),
                       [](const record::PartRow& part) { return part.state == record::PartState::Interrupted; });
  return {};
}

/// Enters a part as its file describes it. If the session ended with this part, enters the session's end too.
core::Status Recordings::enter(const record::FoundRecording& found) {
  const record::PartRow& part = found.part;
  DTS_TRY(catalogue_->enter(found));
  complain(sum_up(part.session_id));
  DTS_TRY_ASSIGN(const auto session, catalogue_->session(part.session_id));
  const bool is_open = session.state == "interrupted" || (session.state == "running" && !under_way_.contains(session.rig));
  const auto newest = record::newest_parts(session);
  if (!is_open || newest.front().leading_part != part.leading_part) return {};
  const ShownEnd end = end_shown_by(newest);
  const std::string state = found.session_state == "aborted" ? found.session_state : end.state;
  return catalogue_->end_session(part.session_id, state, end.message, end.utc_ns);
}

/// Ends a session that is listed as "running" although no session can run yet: it ended with its newest parts, before the catalogue was
/// updated.
void Recordings::end_left_running(record::SessionRow& session) {
  if (session.state != "running") return;
  ShownEnd end = end_shown_by(record::newest_parts(session));
  if (session.parts.empty()) end = {.state = "interrupted", .message = {}, .utc_ns = session.started_utc_ns};
  if (end.state == "interrupted") end.message = "the daemon or the power failed";
  session.state = end.state;
  complain(catalogue_->end_session(session.id, end.state, end.message, end.utc_ns));
  if (session.state == "interrupted") audit("interrupted", session.id, "failed");
}

/// Writes an action of the daemon itself to the audit trail.
void Recordings::audit(const std::string& what, const std::string& target, const std::string& result) {
  enter_audit(
      {.utc_ns = clock_.now_ns() + clock_.utc_minus_monotonic_ns(), .who = "dtsd", .what = what, .target = target, .result = result});
}

/// Finds the sessions that are the last of each of their rigs, if a crash ended them recently. This may be an earlier crash, if the daemon
/// ended again before it resumed the session.
void Recordings::find_resumable(const std::vector<record::SessionRow>& sessions) {
  std::map<std::string, const record::SessionRow*, std::less<>> last;
  for (const record::SessionRow& session : sessions) {
    if (session.parts.empty()) continue;
    for (const std::string& rig : record::rigs_of(session)) {
      const record::SessionRow*& known = last[rig];
      if (known == nullptr || known->parts.back().started_utc_ns < session.parts.back().started_utc_ns) known = &session;
    }
  }
  for (const record::SessionRow& session : sessions) {
    const bool is_last = !session.parts.empty() &&
                         std::ranges::all_of(record::rigs_of(session), [&](const std::string& rig) { return last.at(rig) == &session; });
    if (!is_last || session.state != "interrupted") continue;
    if (std::ranges::none_of(record::newest_parts(session), [this](const record::PartRow& part) { return is_recent(part); })) continue;
    if (is_suspicious(session)) {
      log_.error("session " + session.id +
                 " was interrupted too often, so dtsd does not resume it by itself; resume it: dtsctl session resume " + session.id);
    } else {
      resumable_.push_back(session.id);
    }
  }
}

/// Returns the end of a part that was cut off: from its repaired copy, or from its file, which is written several times a second.
std::optional<std::int64_t> Recordings::cut_off_utc_ns(const record::PartRow& part) {
  if (part.state == record::PartState::Recovered) return end_of_data_utc_ns(part);
  if (part.state != record::PartState::Interrupted) return std::nullopt;
  std::error_code error;
  const auto written = std::filesystem::last_write_time(part.file, error);
  if (error) return std::nullopt;
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::file_clock::to_sys(written).time_since_epoch()).count();
}

/// Returns whether the last three parts of the leading rig were each cut off within 1 min: the session itself may cause the crashes.
bool Recordings::is_suspicious(const record::SessionRow& session) {
  constexpr std::ptrdiff_t kMostShortParts = 3;
  constexpr std::int64_t kShortNs = 60'000'000'000;
  std::vector<record::PartRow> leading;
  std::ranges::copy_if(session.parts, std::back_inserter(leading), &record::PartRow::leads);
  if (std::ssize(leading) < kMostShortParts) return false;
  return std::all_of(leading.end() - kMostShortParts, leading.end(), [&](const record::PartRow& part) {
    const auto end_ns = cut_off_utc_ns(part);
    return end_ns && *end_ns - part.started_utc_ns < kShortNs;
  });
}

bool Recordings::is_recent(const record::PartRow& part) const {
  const auto end_ns = cut_off_utc_ns(part);
  if (!end_ns) return false;
  const auto age = std::chrono::system_clock::now().time_since_epoch() - std::chrono::nanoseconds(*end_ns);
  return std::abs(std::chrono::duration<double, std::ratio<60>>(age).count()) < config_.resume_within_min;
}

void Recordings::add(Rig& rig) {
  bytes_per_s_ += bytes_per_second(rig);
  thread_.add(rig.config().name, rig.tap());
}

void Recordings::start() {
  thread_.start();
  audit("start", "", "ok");
  is_started_ = true;
  if (continued_) start_erasing();
  if (interrupted_.empty()) return;
  log_.warning(std::to_string(interrupted_.size()) + " interrupted recording(s) found; dtsd makes repaired copies");
  is_recovering_ = true;
  recovery_thread_ = std::jthread([this](const std::stop_token& stop) {
    static_cast<void>(core::configure_this_thread("recover", {}));  // default policy, cannot be rejected
    recover_all(stop);
    is_recovering_ = false;
  });
}

void Recordings::stop() noexcept {
  for (std::jthread* thread : {&recovery_thread_, &erasing_thread_}) thread->request_stop();
  for (std::jthread* thread : {&recovery_thread_, &erasing_thread_}) {
    if (thread->joinable()) thread->join();
  }
  catalogue_->wait_at_most(kWaitOtherwise);  // nothing writes the catalogue again any more
  if (std::exchange(is_started_, false)) audit("stop", "", "ok");
  enter_owed_now();
  if (!audit_problem_.empty()) {
    log_.error(std::to_string(owed_audit_.size() + unwritten_audit_) + " entries of the audit trail are lost: " + audit_problem_);
    owed_audit_.clear();
    audit_problem_.clear();
  }
  thread_.stop();
}

/// Returns whether so many further bytes would leave too little free space to start sessions.
bool Recordings::lacks_room(std::uint64_t bytes) const {
  const double left = static_cast<double>(disk().free_bytes) - static_cast<double>(bytes);
  return left < config_.stop_below_mib * 1024.0 * 1024.0 + config_.refuse_below_min * 60.0 * bytes_per_s_;
}

/// Thread: recovery. Copying hours of data is slow, and the daemon must start without a delay.
void Recordings::recover_all(const std::stop_token& stop) {
  for (const record::PartRow& part : interrupted_) {
    record::FoundRecording found;
    found.part = part;
    if (lacks_room(size_of(part.file))) {
      found.part.reason =
          "no room for a repaired copy on the disk of " + sessions_directory(config_) + "; make room: dtsd retries when it starts again";
    } else {
      const std::string copy = record::recovered_name(part.file);
      const auto recovered = record::recover(part.file, copy, [&](std::uint64_t, std::uint64_t) { return !stop.stop_requested(); });
      if (stop.stop_requested() && !recovered) return;
      auto read = recovered ? record::read_recording(copy) : tl::make_unexpected(recovered.error());
      if (read && read->part.state == record::PartState::Recovered) {
        found = std::move(*read);
        found.part.lost_s_at_most = recovered->lost_s_at_most;
        found.part.reason = recovered->reason;
      } else {
        found.part.reason = read ? "the repaired copy cannot be read back: " + read->part.reason : core::to_string(read.error());
      }
    }
    const std::lock_guard lock(recovered_mutex_);
    recovered_.push_back(std::move(found));
  }
}

void Recordings::collect_recovered() {
  std::vector<record::FoundRecording> recovered;
  {
    const std::lock_guard lock(recovered_mutex_);
    recovered = std::exchange(recovered_, {});
  }
  for (const record::FoundRecording& found : recovered) {
    const record::PartRow& part = found.part;
    const std::string which = "session " + part.session_id + " part " + std::to_string(part.part) + ": ";
    if (part.state == record::PartState::Recovered) {
      if (const auto entered = enter(found); !entered) {
        complain(entered);
        complain(catalogue_->update_part(part));
      }
      audit("recover", part.session_id, "ok");
      log_.info(which + "recovered in " + part.file);
    } else {
      complain(catalogue_->update_part(part));
      audit("recover", part.session_id, "failed");
      log_.error(which + "not recovered: " + part.reason);
    }
  }
}

core::Status Recordings::begin(const std::vector<RecordingStart>& starts) {
  const DiskView view = disk();
  if (view.state == DiskState::Full) return core::fail(core::ErrorCode::LimitExceeded, "no session can start: " + view.problem);
  if (view.state == DiskState::Unusable) return core::fail(core::ErrorCode::Failed, "no session can start: " + view.problem);
  if (view.state == DiskState::Low) log_.warning(view.problem);
  for (const auto& [rig, facts] : starts) {
    if (rig.tap().is_done()) continue;
    return core::fail(core::ErrorCode::WrongState, "rig '" + facts.rig + "': the previous recording, which failed, is still being closed",
                      "try again in a second");
  }
  std::vector<std::unique_ptr<record::Recorder>> recorders;
  std::vector<record::NewPart> parts;
  core::Status begun;
  for (const auto& [rig, facts] : starts) {
    auto recorder = record::Recorder::create(file_of(config_, facts), facts, streams_of(rig));
    if (!recorder) {
      begun = tl::make_unexpected(recorder.error());
      break;
    }
    recorders.push_back(std::move(*recorder));
    parts.push_back({.facts = facts, .file = file_of(config_, facts) + ".part"});
  }
  if (begun) begun = explained(catalogue_->begin_parts(parts));
  if (!begun) {
    recorders.clear();  // the files are empty, and the next start would enter them as a session
    for (const record::NewPart& part : parts) {
      for (const char* ending : {".part", ".idx"}) ::unlink((file_of(config_, part.facts) + ending).c_str());
    }
    return begun;
  }
  for (std::size_t index = 0; index < starts.size(); ++index) {
    const auto& [rig, facts] = starts[index];
    under_way_[facts.rig] = {.session_id = facts.session_id,
                             .part = facts.part,
                             .file = parts[index].file,
                             .started_utc_ns = facts.started_utc_ns,
                             .rig = facts.rig,
                             .leading_part = leading_part(facts)};
    thread_.begin(facts.rig, std::move(recorders[index]), file_of(config_, facts), rig.tap().next_take());
  }
  for (const RecordingStart& start : starts) start.rig.tap().open();  // one right after the other: they begin together
  return {};
}

void Recordings::end(Rig& rig) {
  const AcquisitionReport& report = rig.acquisition();
  if (!report.delivers() && report.scans_total > 0) {
    thread_.mark_incomplete(rig.config().name, "the device delivered nothing when the session ended: " + std::string(report.text()));
  }
  rig.tap().close(rig.pipeline_report().end);
}

void Recordings::mark_incomplete(const std::string& rig, std::string reason) { thread_.mark_incomplete(rig, std::move(reason)); }

std::uint32_t Recordings::part(const std::string& rig) const {
  const auto found = under_way_.find(rig);
  return found != under_way_.end() ? found->second.part : 0;
}

std::vector<FinishedRecording> Recordings::take_finished() {
  enter_owed();
  collect_erased();
  if (!erasing_thread_.joinable()) collect_recovered();  // the catalogue may be busy, and these entries are not retried
  std::vector<FinishedRecording> finished = thread_.take_finished();
  for (const FinishedRecording& recording : finished) enter(recording);
  return finished;
}

void Recordings::enter(const FinishedRecording& finished) {
  record::PartRow& part = under_way_[finished.rig];
  part.file = finished.file;
  part.sha256 = finished.sha256;
  part.bytes = finished.bytes;
  part.scans = finished.scans;
  part.duration_s = finished.duration_s;
  part.losses = finished.losses;
  part.reason = finished.incomplete;
  part.state = finished.incomplete.empty() ? record::PartState::Complete : record::PartState::Incomplete;
  if (!finished.is_closed) part.state = record::PartState::Interrupted;  // the next start makes a repaired copy
  enter_or_owe([this, part] { return catalogue_->update_part(part); });
  if (!finished.incomplete.empty()) log_.error("recording " + finished.file + " is incomplete: " + finished.incomplete);
}

void Recordings::end_session(const std::string& id, const std::string& state, const std::string& message, std::int64_t utc_ns) {
  enter_or_owe([=, this] { return catalogue_->end_session(id, state, message, utc_ns); });
  if (!owed_.empty()) owed_ends_[id] = {.id = id, .state = state, .message = message, .ended_utc_ns = utc_ns};
}

bool Recordings::is_being_closed(const record::SessionRow& row) const {
  return std::ranges::any_of(under_way_, [&row](const auto& recorded) {
    return recorded.second.session_id == row.id && recorded.second.state == record::PartState::Recording;
  });
}

record::SessionRow Recordings::corrected(record::SessionRow row) const {
  if (is_being_closed(row)) {
    // The catalogue already has an end, in case the daemon ends before the file is closed. Only the closed file decides how the session
    // ended.
    row.state = "running";
    row.message.clear();
    row.ended_utc_ns = 0;
    return row;
  }
  const auto end = owed_ends_.find(row.id);
  if (end == owed_ends_.end()) return row;
  row.state = end->second.state;
  row.message = end->second.message;
  row.ended_utc_ns = end->second.ended_utc_ns;
  for (const auto& [rig, newest] : under_way_) {
    for (record::PartRow& part : row.parts) {
      if (part.session_id != newest.session_id || part.part != newest.part) continue;
      const std::uint32_t valid_trials = part.valid_trials;
      part = newest;
      part.valid_trials = valid_trials;
    }
  }
  return row;
}

/// Logs an error of the catalogue. The recording has the data; the next start corrects the catalogue from it.
void Recordings::complain(const core::Status& status) {
  if (!status) log_.error("catalogue: " + core::to_string(status.error()));
}

}  // namespace dts::session
