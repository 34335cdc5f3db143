// SPDX-License-Identifier: Apache-2.0
#include "fault/injection.h"

#include <charconv>
#include <chrono>

#include "fault/child_process.h"
#include "fault/recorded_session.h"
#include "fault/rigs.h"
#include "support/patient_clock.h"

namespace dts::fault {
namespace {

constexpr double kSessionS = 2.0;  // some synchronisations, a clock offset, a boundary
constexpr std::chrono::seconds kLimit{60};
constexpr char kSeparator = '\x1f';

struct Run {
  SessionCourse course;
  std::string refusal;  ///< The daemon did not start.
};

Run run_session(const std::string& folder) {
  test::PatientClock clock(kClockStepNs);
  clock.start();
  auto session = RecordedSession::open(folder, floor4_rig(), clock);
  if (!session) return {.course = {}, .refusal = core::to_string(session.error())};
  Run run{.course = (*session)->start(), .refusal = {}};
  if (!run.course.has_started) return run;
  (*session)->run_for(kSessionS);
  (*session)->stop(run.course);
  return run;
}

std::string outcome_of(const Afterwards& after) {
  return after.sessions.empty() || after.sessions.front().parts.empty()
             ? "refused"
             : std::string(record::name(after.sessions.front().parts.front().state));
}

std::string problem_of(const Run& run, const Afterwards& after) {
  if (!run.course.hang.empty()) return run.course.hang;
  if (!after.problem.empty()) return after.problem;
  const bool is_listed = !after.sessions.empty() && after.sessions.front().id == run.course.session_id;
  if (run.course.has_started && !is_listed) return "a session that had started is not in the catalogue";
  return {};
}

/// "struck outcome problem", with separators: what a child can send.
std::string run_with(const Fault& fault, const Reference& reference) {
  const TemporaryFolder folder;
  FaultyDisk disk(folder.path());
  disk.arm(fault);
  const Run run = run_session(folder.path() + "/state");
  disk.disarm();
  const Afterwards after = look_afterwards(folder.path() + "/state", reference);
  return std::string(disk.has_struck() ? "1" : "0") + kSeparator + outcome_of(after) + kSeparator + problem_of(run, after);
}

}  // namespace

std::string record_little_session(const std::string& folder) {
  const Run run = run_session(folder);
  return run.refusal + run.course.refusal + run.course.hang;
}

Reference little_reference() { return Reference::compute(floor4_rig(), 600.0); }

CallCounts count_calls(const Reference& reference) {
  const std::string text = run_in_child(
      [&] {
        const TemporaryFolder folder;
        FaultyDisk disk(folder.path());
        const Run run = run_session(folder.path() + "/state");
        std::string counts;
        for (const Operation operation : kOperations) counts += std::to_string(disk.calls(operation)) + kSeparator;
        const Afterwards after = look_afterwards(folder.path() + "/state", reference);
        if (!run.refusal.empty() || !run.course.refusal.empty()) return "no session on a sound disk: " + run.refusal + run.course.refusal;
        if (!problem_of(run, after).empty() || outcome_of(after) != "complete") {
          return "a sound disk: " + outcome_of(after) + " " + problem_of(run, after);
        }
        return counts;
      },
      kLimit);
  CallCounts counts;
  const char* at = text.data();
  const char* const end = at + text.size();
  for (std::uint64_t& calls : counts.calls) {
    const auto [next, error] = std::from_chars(at, end, calls);
    if (error != std::errc() || next == end || *next != kSeparator) return {.calls = {}, .problem = text};
    at = next + 1;
  }
  return counts;
}

Injected inject(const Fault& fault, const Reference& reference) {
  const std::string text = run_in_child([&] { return run_with(fault, reference); }, kLimit);
  const std::size_t first = text.find(kSeparator);
  const std::size_t second = first == std::string::npos ? first : text.find(kSeparator, first + 1);
  if (second == std::string::npos) return {.problem = text.empty() ? "ended without an answer" : text, .has_struck = true, .outcome = "?"};
  return {.problem = text.substr(second + 1), .has_struck = text[0] == '1', .outcome = text.substr(first + 1, second - first - 1)};
}

std::vector<Fault> all_faults(const CallCounts& counts) {
  std::vector<Fault> faults;
  for (const Operation operation : kOperations) {
    for (std::uint64_t nth = 1; nth <= counts.calls[static_cast<std::size_t>(operation)]; ++nth) {
      for (const bool is_lasting : {false, true}) {
        const int error = kErrors[faults.size() / 2 % kErrors.size()];
        faults.push_back({.operation = operation, .nth = nth, .error = error, .is_lasting = is_lasting});
      }
    }
  }
  return faults;
}

}  // namespace dts::fault
