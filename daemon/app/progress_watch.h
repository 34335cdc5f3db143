// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "session/supervisor.h"

namespace dts::app {

/// Checks that the daemon makes progress. The daemon sends keep-alives to systemd's watchdog only while each device delivers scans or its
/// thread waits for them or for room for them, scans move through the pipeline, and the publish thread runs. A plain timer would keep a
/// frozen daemon alive for ever.
///
/// If a rig's thread opens a device for longer than `kOpeningNs` (a driver that does not return), its rig is hung. A hung rig counts as
/// stuck only if no other rig has a session, because the restart would interrupt that session. The record thread is not checked: a slow
/// disk may hold it while the stream goes well. The control thread is checked because it makes this call: it also writes the catalogue, so
/// a disk that hangs for longer than WatchdogSec ends the daemon. Thread: control.
class ProgressWatch {
 public:
  /// `patience_ns`: longest time without progress.
  explicit ProgressWatch(std::int64_t patience_ns) : patience_ns_(patience_ns) {}

  /// Returns the name of a part without progress for too long, such as "the pipeline of rig 'floor'"; empty if there is none.
  /// `publish_turns`: a counter that rises while the publish thread works.
  [[nodiscard]] std::string stuck_part(const std::vector<session::RigState>& rigs, std::uint64_t publish_turns, std::int64_t now_ns);

  /// Returns a message with what to do for each rig that the last `stuck_part` found newly hung, whether or not it counts as stuck.
  [[nodiscard]] const std::vector<std::string>& new_hangs() const noexcept { return new_hangs_; }

 private:
  struct Part {
    std::uint64_t mark = 0;
    std::int64_t moved_ns = 0;
  };
  /// Stores the progress `mark` of a part; returns true if the part had work but no progress for too long.
  [[nodiscard]] bool is_stuck(const std::string& name, std::uint64_t mark, bool has_work, std::int64_t now_ns, std::int64_t patience_ns);
  void find_hung_rigs(const std::vector<session::RigState>& rigs, std::int64_t now_ns);

  static constexpr std::int64_t kOpeningNs = 60'000'000'000;  // longer than loading an FPGA image with a timeout on every request

  std::int64_t patience_ns_;
  std::int64_t looked_ns_ = 0;
  std::map<std::string, Part> parts_;
  std::set<std::string> hung_rigs_;
  std::vector<std::string> new_hangs_;
};

}  // namespace dts::app
