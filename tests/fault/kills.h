// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>

#include "core/clock.h"
#include "fault/reference.h"
#include "system/daemon_process.h"

namespace dts::fault {

inline constexpr double kPromisedS = 1.0;         ///< A killed daemon loses at most so much, on a machine that is in time.
inline constexpr double kMostMachineLateS = 1.0;  ///< A loss on a machine that was later than this proves nothing: the round is repeated.

/// What one SIGKILL cost.
struct Killed {
  double recorded_s = 0.0;           ///< From the session's start to the kill.
  double lost_s = 0.0;               ///< From the recovered file's last time stamp to the kill.
  double published_lost_s = 0.0;     ///< From there to the last scan that a subscriber had: without what the machine made late.
  double told_lost_s_at_most = 0.0;  ///< What the catalogue says.
  double machine_late_s = 0.0;       ///< By so much the machine may have made a record thread late.
  std::string problem;               ///< A promise that was broken; empty: none.
  bool is_undecided = false;         ///< Too much is lost, but the machine was too late to blame the daemon for it.
};

/// Real daemons, one after the other, in one state folder: record the floor with 16 sensors at 1500 Hz, are killed, and are started again.
/// Every start has to list the session as interrupted and to recover it. Thread: one at a time; several objects may run side by side.
class KillLine {
 public:
  KillLine(const Reference& reference, std::uint32_t seed);

  /// Kills after 0.05..`longest_s` of recording. Repeats a round that is undecided; fails it if it stays so.
  [[nodiscard]] Killed run_round(double longest_s);

 private:
  struct Seen {
    double killed_s = 0.0;
    double published_s = 0.0;  ///< 0: nothing came.
  };
  [[nodiscard]] Killed run_once(double longest_s);
  [[nodiscard]] Seen watch_and_kill(client::Subscriber& subscriber, std::int64_t at_ns);
  [[nodiscard]] std::string find_recovered(const std::string& session, v1::SessionRecord& found);
  [[nodiscard]] std::string judge(const v1::SessionPart& part, const Seen& seen, double started_s, Killed& killed) const;

  const Reference& reference_;
  std::mt19937 random_;
  test::DaemonProcess daemon_;
  core::SystemClock clock_;
};

}  // namespace dts::fault
