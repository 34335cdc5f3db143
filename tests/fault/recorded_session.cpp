// SPDX-License-Identifier: Apache-2.0
#include "fault/recorded_session.h"

#include <algorithm>
#include <chrono>

#include "fault/rigs.h"
#include "record/xdf/recovery.h"
#include "support/patient_clock.h"

namespace dts::fault {
namespace {

using Real = std::chrono::steady_clock;
using record::PartState;

constexpr std::chrono::seconds kPatience{100};  // by the real clock: more is a hang

std::string where(const record::PartRow& part) {
  return "session " + part.session_id + " part " + std::to_string(part.part) + " (" + std::string(record::name(part.state)) + "): ";
}

/// What a closed file says of itself beside what the catalogue says of it.
std::string check_file(const record::PartRow& part) {
  const auto verified = record::verify(part.file);
  if (!verified) return where(part) + core::to_string(verified.error());
  if (!verified->is_closed) return where(part) + "listed as closed, and has no footers";
  if (verified->sha256 != part.sha256) return where(part) + "the SHA-256 in the catalogue is not the file's";
  const bool can_say = verified->scans > 0;  // it stands in the footers of streams: without any there is no place for it
  if (part.state == PartState::Complete && !verified->incomplete.empty()) {
    return where(part) + "the file says that it is incomplete: " + verified->incomplete;
  }
  if (part.state == PartState::Incomplete && verified->incomplete.empty() && can_say) {
    return where(part) + "the file does not say that it is incomplete";
  }
  if (part.state == PartState::Recovered && can_say && !verified->is_recovered)
    return where(part) + "the file does not say that it is recovered";
  if (part.state != PartState::Recovered && verified->scans < part.scans) return where(part) + "fewer scans in the file than listed";
  return {};
}

std::string check_content(const record::PartRow& part, const Reference& reference) {
  const auto raw = read_raw(part.file);
  if (!raw) return where(part) + core::to_string(raw.error());
  if (part.state == PartState::Complete && (raw->losses > 0 || !raw->damage.empty())) return where(part) + "scans are missing in the file";
  if (std::string difference = reference.difference(*raw); !difference.empty()) return where(part) + difference;
  if (raw->scans == 0) return {};
  if (std::string refusal = check_with_libxdf(part.file, *raw); !refusal.empty()) return where(part) + refusal;
  return {};
}

std::string check_part(const record::PartRow& part, const Reference& reference) {
  switch (part.state) {
    case PartState::Recording: return where(part) + "nobody records it";
    case PartState::Interrupted: return where(part) + "not recovered: " + part.reason;
    case PartState::Missing: return where(part) + "its file is gone: " + part.file;
    case PartState::Complete: break;
    case PartState::Incomplete:
    case PartState::Recovered:
      if (part.reason.empty()) return where(part) + "no reason is given";
      break;
  }
  std::string problem = check_file(part);
  return problem.empty() ? check_content(part, reference) : problem;
}

/// A session may not be called complete when a part of it is not.
std::string check_session(const record::SessionRow& session) {
  if (session.state == "running") return "session " + session.id + " is listed as running";
  const bool is_whole = std::ranges::all_of(session.parts, [](const auto& part) { return part.state == PartState::Complete; });
  if (session.state == "complete" && !is_whole) return "session " + session.id + " is listed as complete, and its recording is not";
  return {};
}

bool has_interrupted(const record::Catalogue& catalogue) {
  const auto parts = catalogue.parts();
  return parts && std::ranges::any_of(*parts, [](const auto& part) { return part.state == PartState::Interrupted; });
}

}  // namespace

session::StorageConfig storage_in(const std::string& folder) {
  return {.directory = folder, .refuse_below_min = 0.0, .warn_below_min = 0.0, .stop_below_mib = 0.0};
}

RecordedSession::RecordedSession(core::Clock& clock, std::unique_ptr<session::Recordings> recordings)
    : clock_(clock),
      recordings_(std::move(recordings)),
      supervisor_(clock, core::Log(), nullptr,
                  {.recordings = *recordings_, .worker = worker_, .software = "fault test", .boot_id = "none"}) {}

RecordedSession::~RecordedSession() { supervisor_.stop(); }

core::Result<std::unique_ptr<RecordedSession>> RecordedSession::open(const std::string& folder, pipeline::RigConfig config,
                                                                     core::Clock& clock) {
  auto recordings = session::Recordings::open(storage_in(folder), clock, core::Log());
  if (!recordings) return tl::make_unexpected(recordings.error());
  std::unique_ptr<RecordedSession> session(new RecordedSession(clock, std::move(*recordings)));
  auto rig = session::Rig::create(std::move(config), clock, session->bell_);
  if (!rig) return tl::make_unexpected(rig.error());
  if (auto added = session->supervisor_.add(std::move(*rig)); !added) return tl::make_unexpected(added.error());
  session->supervisor_.start();
  return session;
}

void RecordedSession::tick() {
  supervisor_.tick();
  static_cast<void>(supervisor_.take_notices());  // nobody listens
  clock_.sleep_until_ns(clock_.now_ns() + 50'000'000);
}

bool RecordedSession::tick_until(const std::function<bool()>& condition) {
  const auto deadline = Real::now() + kPatience;
  while (!condition()) {
    if (Real::now() > deadline) return false;
    tick();
  }
  return true;
}

void RecordedSession::audit(const std::string& what, const std::string& target) {
  recordings_->enter_audit({.utc_ns = 1, .who = "local", .what = what, .target = target, .result = "ok", .hash = {}});
}

SessionCourse RecordedSession::start(const std::string& subject) {
  SessionCourse course;
  if (!tick_until([&] { return supervisor_.rigs().front()->acquisition().scans_total > 0; })) {
    course.hang = "no scan arrives";
    return course;
  }
  const auto started = supervisor_.start_session("floor", {.subject = subject, .label = "fault"});
  audit("start_session", "floor");
  course.has_started = started.has_value();
  if (started) course.session_id = started->id;
  if (!started) course.refusal = core::to_string(started.error());
  return course;
}

void RecordedSession::run_for(double seconds, const std::function<void()>& between) {
  const std::int64_t until_ns = clock_.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
  bool is_marked = false;
  while (clock_.now_ns() < until_ns) {
    if (!std::exchange(is_marked, true)) static_cast<void>(supervisor_.mark("floor", "begins"));
    tick();
    if (between) between();
  }
}

void RecordedSession::stop(SessionCourse& course) {
  if (supervisor_.session("floor").value().state == session::SessionState::Running) {
    static_cast<void>(supervisor_.stop_session("floor"));  // refused: a fault ended it already
  }
  audit("stop_session", "floor");
  course.is_over = tick_until([&] { return !supervisor_.states().front().recording.is_recording; });
  if (!course.is_over) course.hang = "the recording does not end";
  tick();  // enters the end into the catalogue
}

Afterwards look_afterwards(const std::string& folder, const Reference& reference) {
  test::PatientClock clock(kClockStepNs);
  clock.start();
  auto recordings = session::Recordings::open(storage_in(folder), clock, core::Log());
  if (!recordings) return {.problem = "the next start fails: " + core::to_string(recordings.error())};
  record::Catalogue& catalogue = (*recordings)->catalogue();
  (*recordings)->start();
  const auto deadline = Real::now() + kPatience;
  while (has_interrupted(catalogue) && Real::now() < deadline) {
    static_cast<void>((*recordings)->take_finished());
    clock.sleep_until_ns(clock.now_ns() + 50'000'000);
  }
  (*recordings)->stop();
  // The second trail is not synchronised: a fault or a power cut may have taken it, and the next entry makes it anew.
  (*recordings)->enter_audit({.utc_ns = 2, .who = "local", .what = "look", .target = "floor", .result = "ok", .hash = {}});
  if (const auto audited = catalogue.verify_audit(); !audited) return {.problem = core::to_string(audited.error())};
  auto sessions = catalogue.sessions({.limit = 10'000});
  if (!sessions) return {.problem = core::to_string(sessions.error())};
  for (const record::SessionRow& session : *sessions) {
    if (std::string problem = check_session(session); !problem.empty()) return {.problem = problem};
    for (const record::PartRow& part : session.parts) {
      if (std::string problem = check_part(part, reference); !problem.empty()) return {.problem = problem};
    }
  }
  return {.problem = {}, .sessions = std::move(*sessions)};
}

}  // namespace dts::fault
