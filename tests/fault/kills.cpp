// SPDX-License-Identifier: Apache-2.0
#include "fault/kills.h"

#include <signal.h>

#include <algorithm>
#include <fstream>

#include "fault/recorded_raw.h"
#include "fault/rigs.h"
#include "record/xdf/recovery.h"
#include "support/machine_lateness.h"

namespace dts::fault {
namespace {

constexpr double kShortestS = 0.05;
constexpr int kMostTries = 5;                           // of one round
constexpr std::chrono::milliseconds kRecordPeriod{40};  // the daemon's record thread wakes so often
constexpr double kLateTurns = 3.0;                      // some turns of the record thread may each be as late as the latest of ours

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

double end_of(const client::Block& block) {
  const double period_s = 1.0 / block.rate.hz();
  return seconds(block.host_time_ns) + static_cast<double>(block.scan_count - 1) * period_s;
}

}  // namespace

KillLine::KillLine(const Reference& reference, std::uint32_t seed) : reference_(reference), random_(seed) {
  daemon_.signal(SIGTERM);
  static_cast<void>(daemon_.wait());
  std::ofstream(daemon_.directory() / "rigs" / "floor.toml") << floor16_text();
  daemon_.restart();
}

/// Receives until the moment has come, and what had been sent by then.
KillLine::Seen KillLine::watch_and_kill(client::Subscriber& subscriber, std::int64_t at_ns) {
  Seen seen;
  const auto receive = [&](std::chrono::milliseconds timeout) {
    const auto message = subscriber.receive(timeout);
    if (!message || !*message) return false;
    if (const auto* block = std::get_if<client::Block>(&**message)) seen.published_s = std::max(seen.published_s, end_of(*block));
    return true;
  };
  while (clock_.now_ns() < at_ns) static_cast<void>(receive(std::chrono::milliseconds(1)));
  const std::int64_t killed_ns = clock_.now_ns();
  daemon_.signal(SIGKILL);
  static_cast<void>(daemon_.wait());
  while (receive(std::chrono::milliseconds(0))) {
  }
  seen.killed_s = seconds(killed_ns);
  return seen;
}

/// Waits until the daemon has made its repaired copy; nothing else may be claimed before.
std::string KillLine::find_recovered(const std::string& session, v1::SessionRecord& found) {
  auto control = daemon_.control();
  std::string problem = "the session is not listed";
  const bool is_recovered = test::eventually([&] {
    const auto shown = control.show_session(session);
    if (!shown) return false;
    found = *shown;
    problem =
        "not recovered: session " + found.state() + ", part " + v1::PartState_Name(found.parts(0).state()) + " " + found.parts(0).reason();
    return found.parts(0).state() == v1::PART_STATE_RECOVERED;
  });
  if (!is_recovered) return problem;
  return found.state() == "interrupted" ? "" : "the session is listed as " + found.state();
}

std::string KillLine::judge(const v1::SessionPart& part, const Seen& seen, double started_s, Killed& killed) const {
  const auto verified = record::verify(part.file());
  if (!verified) return core::to_string(verified.error());
  if (!verified->is_closed || !verified->is_recovered) return part.file() + " does not say that it is recovered";
  if (verified->sha256 != part.sha256()) return "the catalogue's SHA-256 is not that of " + part.file();
  const auto raw = read_raw(part.file());
  if (!raw) return core::to_string(raw.error());
  const double last_s = raw->scans > 0 ? raw->last_time_s : started_s;
  killed.lost_s = seen.killed_s - last_s;
  killed.published_lost_s = seen.published_s > 0.0 ? std::max(0.0, seen.published_s - last_s) : 0.0;
  killed.told_lost_s_at_most = part.lost_s_at_most();
  if (raw->losses > 0) return "scans found no room on the way to the file";
  if (std::string difference = reference_.difference(*raw); !difference.empty()) return difference;
  if (std::string refusal = raw->scans > 0 ? check_with_libxdf(part.file(), *raw) : ""; !refusal.empty()) return refusal;
  if (killed.lost_s > kPromisedS + std::min(killed.machine_late_s, kMostMachineLateS)) {
    killed.is_undecided = killed.machine_late_s > kMostMachineLateS;
    return std::to_string(killed.lost_s) + " s are lost, of which " + std::to_string(killed.published_lost_s) +
           " s had been published; the machine was " + std::to_string(killed.machine_late_s) + " s late";
  }
  return {};
}

Killed KillLine::run_round(double longest_s) {
  Killed killed = run_once(longest_s);
  for (int tries = 1; killed.is_undecided && tries < kMostTries; ++tries) killed = run_once(longest_s);
  if (killed.is_undecided) killed.problem = "undecided " + std::to_string(kMostTries) + " times: " + killed.problem;
  return killed;
}

Killed KillLine::run_once(double longest_s) {
  Killed killed;
  auto subscriber = daemon_.subscribe({"floor/raw"});
  auto control = daemon_.control();
  v1::StartSessionRequest request;
  request.set_rig("floor");
  request.set_protocol("free");
  const auto started = control.start_session(request);
  const std::int64_t started_ns = clock_.now_ns();
  if (!started) {
    killed.problem = "no session starts: " + started.error().what;
    return killed;
  }
  const double wait_s = std::uniform_real_distribution<double>(kShortestS, longest_s)(random_);
  const test::DiskProbe disk(daemon_.state_directory());
  const test::MachineLateness lateness(kRecordPeriod, [&disk] { disk.write(); });
  const Seen seen = watch_and_kill(subscriber, started_ns + static_cast<std::int64_t>(wait_s * 1e9));
  killed.machine_late_s = kLateTurns * lateness.worst_s();
  killed.recorded_s = seen.killed_s - seconds(started_ns);
  daemon_.restart();
  v1::SessionRecord found;
  killed.problem = daemon_.is_ready() ? find_recovered(started->session_id(), found) : "the daemon does not start again: " + daemon_.log();
  if (killed.problem.empty()) killed.problem = judge(found.parts(0), seen, seconds(started_ns), killed);
  return killed;
}

}  // namespace dts::fault
