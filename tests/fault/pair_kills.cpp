// SPDX-License-Identifier: Apache-2.0
#include "fault/pair_kills.h"

#include <signal.h>

#include <chrono>
#include <thread>

#include "fault/recorded_raw.h"
#include "fault/rigs.h"
#include "record/xdf/recovery.h"

namespace dts::fault {
namespace {

constexpr double kShortestRoundS = 0.05;
constexpr int kResumedByItself = 2;  // after three short parts the daemon leaves it to a person

test::DaemonProcess::Options two_rigs() {
  return {.device = kDevice,
          .acquire = {},
          .stages = {},
          .daemon = "[storage]\nresume_within_min = 10.0\n",
          .further_rigs = {{.name = "plate", .device = kDevice}}};
}

std::string check(const v1::SessionPart& part, const Reference& reference) {
  const std::string where = "part " + std::to_string(part.part()) + " of rig '" + part.rig() + "': ";
  const auto verified = record::verify(part.file());
  if (!verified) return where + core::to_string(verified.error());
  if (!verified->is_closed || verified->sha256 != part.sha256()) return where + "its file is not the one in the catalogue";
  const auto raw = read_raw(part.file());
  if (!raw) return where + core::to_string(raw.error());
  if (raw->facts.rig != part.rig() || raw->losses > 0) return where + "another rig, or scans found no room on the way to the file";
  if (const std::string difference = reference.difference(*raw); !difference.empty()) return where + difference;
  const std::string refusal = raw->scans > 0 ? check_with_libxdf(part.file(), *raw) : "";
  return refusal.empty() ? "" : where + refusal;
}

}  // namespace

PairKills::PairKills(std::uint32_t seed) : random_(seed), daemon_(two_rigs()) {}

/// Returns whether the session runs on both rigs.
bool PairKills::runs() const {
  const auto status = daemon_.control().status();
  if (!status || status->rigs_size() != 2) return false;
  for (const v1::RigStatus& rig : status->rigs()) {
    if (rig.session().session_id() != session_ || rig.session().state() != v1::SESSION_STATE_RUNNING) return false;
  }
  return true;
}

std::string PairKills::run_round(double longest_s) {
  if (session_.empty()) {
    v1::StartSessionRequest request;
    request.set_rig("floor");
    request.add_companions("plate");
    request.set_protocol("free");
    const bool has_started = test::eventually([&] {  // the rigs need a moment until they stream
      const auto started = daemon_.control().start_session(request);
      if (started) session_ = started->session_id();
      return started.has_value();
    });
    if (!has_started || !test::eventually([this] { return runs(); })) return "no session starts on both rigs: " + daemon_.log();
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(std::uniform_real_distribution<double>(kShortestRoundS, longest_s)(random_)));
  daemon_.signal(SIGKILL);
  static_cast<void>(daemon_.wait());
  daemon_.restart();
  if (!daemon_.is_ready()) return "the daemon does not start again: " + daemon_.log();
  const bool is_resumed_by_hand = ++rounds_ > kResumedByItself;
  const bool has_continued =
      test::eventually([&] { return runs() || (is_resumed_by_hand && daemon_.control().resume_session(session_) && runs()); });
  return has_continued ? "" : "the session does not continue on both rigs: " + daemon_.log();
}

std::string PairKills::finish(const Reference& reference) {
  auto control = daemon_.control();
  if (auto stopped = control.stop_session("plate"); !stopped) return "it cannot be stopped: " + stopped.error().what;
  const int parts = 2 * (rounds_ + 1);
  v1::SessionRecord session;
  const bool is_recovered = test::eventually([&] {  // the repaired copies are made aside
    session = control.show_session(session_).value_or(v1::SessionRecord());
    return session.parts_size() == parts && session.state() == "recovered";
  });
  if (!is_recovered) return "it is listed as " + session.state() + " with " + std::to_string(session.parts_size()) + " parts";
  for (int index = 0; index < parts; ++index) {
    const v1::SessionPart& part = session.parts(index);
    const bool leads = index % 2 == 0;
    const v1::PartState wanted = index >= parts - 2 ? v1::PART_STATE_COMPLETE : v1::PART_STATE_RECOVERED;
    const std::uint32_t leading = leads ? 0 : part.part() - 1;
    if (part.rig() != (leads ? "floor" : "plate") || part.leading_part() != leading || part.state() != wanted) {
      return "part " + std::to_string(part.part()) + " is not as expected: " + part.ShortDebugString();
    }
    if (std::string problem = check(part, reference); !problem.empty()) return problem;
  }
  return {};
}

}  // namespace dts::fault
