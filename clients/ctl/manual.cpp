// SPDX-License-Identifier: Apache-2.0
#include "ctl/manual.h"

#include <string>

#include "cli/documents.h"

namespace dts::ctl {

cli::Manual make_manual() {
  return {
      .summary = "command line of the distributive tactile sensing daemon",
      .description =
          "Controls a running\n.BR dtsd (8):\nshows its state and live data, starts and stops sessions, sets markers.\nVerifies, "
          "repairs and exports recordings; these commands also work on files without a daemon.",
      .environment = {{"DTSD_CONTROL, DTSD_DATA", "Addresses of the daemon's control and data sockets."},
                      {"DTSD_KEY", "Key file of this machine, like \\-\\-key."},
                      {"DTSD_RUNTIME_DIR", "Directory of the daemon's sockets, control.sock and data.sock."},
                      {"XDG_RUNTIME_DIR", "Its subdirectory dtsd is used if no daemon runs as a system service."},
                      {"NO_COLOR", "If set, the output has no colours."}},
      .exit_statuses = {0, 1, 2, 3, 4, 5, 6, 7, 130},
      .further_sections =
          std::string(
              ".SH JSON\nNumbers are numbers. What is undefined is absent; an undefined value among samples is null. Lines of\n.B watch "
              "\\-\\-jsonl\nhave the keys topic, rig, stream, segment, first_scan, rate_hz, host_time_ns, sequence, lost_scans (missed by "
              "this client just before), age_ms, quality (doubtful channels only), channels, units and values, one array per "
              "scan.\nEvents have their own fields under event, with kind saying which they are.\n") +
          cli::kJsonErrors,
      .files = {{"/run/dtsd/control.sock, /run/dtsd/data.sock", "Sockets of the daemon that runs as a system service."}},
      .see_also = {{"dtsd", 8}, {"jq", 1}}};
}

}  // namespace dts::ctl
