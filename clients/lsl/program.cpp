// SPDX-License-Identifier: Apache-2.0
#include "lsl/program.h"

#include <signal.h>

#include "cli/command_line.h"
#include "cli/exit_status.h"
#include "cli/run.h"
#include "core/clock.h"
#include "core/process.h"
#include "lsl/bridge.h"

namespace dts::lsl {
namespace {

int offer_streams(const std::string& file, cli::Console& console) {
  files::Problems problems;
  const Settings settings = file.empty() ? Settings() : load_settings(file, problems);
  for (const auto& problem : problems) cli::print_error(console, files::to_string(problem));
  if (!problems.empty()) return cli::kUsage;
  const auto endpoints = client::find_endpoints(settings.daemon);
  if (!endpoints) return cli::fail_with(console, endpoints.error());
  if (!endpoints->control.starts_with("ipc://") || !endpoints->data.starts_with("ipc://")) {
    return cli::fail_with(console, core::Error{core::ErrorCode::InvalidArgument,
                                               "dts-lsl runs on the daemon's machine, and the addresses of " + endpoints->origin +
                                                   " are not both local sockets",
                                               "set addresses that begin with ipc://, or none"});
  }
  core::block_signals({SIGTERM, SIGINT});
  core::raise_descriptor_limit();
  const auto lsl = Liblsl::load(settings.library);
  if (!lsl) return cli::fail_with(console, lsl.error());
  const auto log = core::Log::to_stderr(settings.log_level);
  core::SystemClock clock;
  const auto ended = run_bridge(settings, *endpoints, **lsl, clock, log);
  return ended ? cli::kOk : cli::fail_with(console, ended.error());
}

cli::Manual make_manual() {
  return {.summary = "streams of the distributive tactile sensing daemon in LSL",
          .description =
              "Offers the streams and events of\n.BR dtsd (8)\nas outlets of the lab streaming layer (LSL), and sets markers of "
              "other programs in LSL in sessions. LSL has no authentication: everybody whom its network packets reach can "
              "read. Needs liblsl, which it loads when it starts.",
          .environment = {{"DTSD_CONTROL, DTSD_DATA", "Addresses of the daemon's control and data sockets."},
                          {"DTSD_RUNTIME_DIR", "Directory of the daemon's sockets, control.sock and data.sock."},
                          {"LSLAPICFG", "File with LSL's own settings, as newer versions of liblsl read it."}},
          .exit_statuses = {0, 1, 2, 4, 5},
          .further_sections = {},
          .files = {{"/etc/dtsd/lsl.toml", "The configuration."},
                    {"/etc/dtsd/lsl_api.cfg", "LSL's own settings for the service, which runs in this folder: only this machine."}},
          .see_also = {{"dtsd", 8}, {"dtsctl", 1}}};
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  std::string file;
  cli::CommandLine line({.name = "dts-lsl",
                         .version = DTS_VERSION,
                         .description = "Offers the streams and events of dtsd in LSL until SIGTERM or Ctrl-C",
                         .examples = "dts-lsl | everything, with the liblsl of the system\n"
                                     "dts-lsl --config /etc/dtsd/lsl.toml | as the service does\n"});
  cli::run_without_command(line, [&file](cli::Console& talk) { return offer_streams(file, talk); });
  line.app.add_option("--config", file, "Configuration file; default: none, and all defaults")->option_text("FILE");
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::lsl
