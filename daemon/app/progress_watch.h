// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "session/supervisor.h"

namespace dts::app {

/// Whether the work goes on: systemd's watchdog is fed only while scans move from every device through its pipeline and the publish thread
/// takes its turns. A timer in a frozen daemon would feed it for ever.
///
/// An acquire thread that hangs while it opens a device (a driver that does not return) is hung after `kOpeningNs`. It is stuck, too, while
/// no other rig has a session: a restart would interrupt those. Not judged: the record thread. The control thread, which asks, is judged by
/// asking at all: it writes the catalogue, so a disk that hangs for longer than WatchdogSec ends the daemon. Thread: control.
class ProgressWatch {
 public:
  /// `patience_ns`: for how long a part may stand still.
  explicit ProgressWatch(std::int64_t patience_ns) : patience_ns_(patience_ns) {}

  /// What has stood still for too long, "the pipeline of rig 'floor'"; empty: nothing. `publish_turns` counts up while that thread lives.
  [[nodiscard]] std::string stuck_part(const std::vector<session::RigState>& rigs, std::uint64_t publish_turns, std::int64_t now_ns);

  /// Says of each rig that was found hung by the last look, and not by the one before, what to do: stuck or not.
  [[nodiscard]] const std::vector<std::string>& new_hangs() const noexcept { return new_hangs_; }

 private:
  struct Part {
    std::uint64_t mark = 0;
    std::int64_t moved_ns = 0;
  };
  /// Notes how far a part is; true when it has not moved for too long. `has_work`: it could have.
  [[nodiscard]] bool is_stuck(const std::string& name, std::uint64_t mark, bool has_work, std::int64_t now_ns, std::int64_t patience_ns);
  void find_hung_rigs(const std::vector<session::RigState>& rigs, std::int64_t now_ns);

  static constexpr std::int64_t kOpeningNs = 60'000'000'000;  // an FPGA image and every request unanswered take less

  std::int64_t patience_ns_;
  std::int64_t looked_ns_ = 0;
  std::map<std::string, Part> parts_;
  std::set<std::string> hung_rigs_;
  std::vector<std::string> new_hangs_;
};

}  // namespace dts::app
