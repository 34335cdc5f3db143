// SPDX-License-Identifier: Apache-2.0
#include "fleet/forward/program.h"

#include <signal.h>
#include <sys/stat.h>

#include "cli/command_line.h"
#include "cli/exit_status.h"
#include "cli/run.h"
#include "core/clock.h"
#include "core/process.h"
#include "fleet/forward/forwarder.h"
#include "fleet/forward/settings.h"
#include "fleet/forward/status_view.h"
#include "fleet/wire/nkey.h"

namespace dts::fleet::forward {
namespace {

struct Arguments {
  std::string file;
  std::string sha256;
  bool is_json = false;
};

int print_problems(const files::Problems& problems, cli::Console& console) {
  for (const auto& problem : problems) cli::print_error(console, files::to_string(problem));
  return cli::kUsage;
}

int run_command(const Arguments& arguments, cli::Console& console) {
  files::Problems problems;
  const Settings settings = load_settings(arguments.file, true, problems);
  if (!problems.empty()) return print_problems(problems, console);
  core::block_signals({SIGTERM, SIGINT});
  core::raise_descriptor_limit();
  const auto log = core::Log::to_stderr(core::LogLevel::Info);
  const auto ended = run_forwarder(settings, log);
  return ended ? cli::kOk : cli::fail_with(console, ended.error());
}

int key_command(const Arguments& arguments, cli::Console& console) {
  files::Problems problems;
  const Settings settings = load_settings(arguments.file, false, problems);
  if (!problems.empty()) return print_problems(problems, console);
  const auto key = wire::read_or_create_nkey(settings.key_file);
  if (!key) return cli::fail_with(console, key.error());
  console.out << key->public_key << '\n';
  cli::print_hint(console, "send this public key to the centre: dts-fleet clinic add NAME --key " + key->public_key + " ...");
  return cli::kOk;
}

/// Calls `action` with the settings and the store of the program.
template <class Action>
int with_store(const Arguments& arguments, cli::Console& console, Action action) {
  files::Problems problems;
  const Settings settings = load_settings(arguments.file, true, problems);
  if (!problems.empty()) return print_problems(problems, console);
  struct stat found {};
  if (::stat((settings.state_folder + "/sent.sqlite").c_str(), &found) != 0) {
    return cli::fail_with(
        console, core::Error{core::ErrorCode::NotFound, "dts-forward has not run yet: " + settings.state_folder + " has no sent.sqlite",
                             "systemctl start dts-forward"});
  }
  const auto store = Store::open(settings.state_folder);
  if (!store) return cli::fail_with(console, store.error());
  return action(settings, **store);
}

int status_command(const Arguments& arguments, cli::Console& console) {
  return with_store(arguments, console, [&arguments, &console](const Settings& settings, const Store& store) {
    if (!arguments.sha256.empty()) return print_file(store, arguments.sha256, arguments.is_json, console);
    const core::SystemClock clock;
    return print_status(store, settings.clinic, clock.now_ns() + clock.utc_minus_monotonic_ns(), arguments.is_json, console);
  });
}

int offer_again_command(const Arguments& arguments, cli::Console& console) {
  return with_store(arguments, console, [&console](const Settings& /*settings*/, Store& store) {
    if (const auto done = store.offer_again(); !done) return cli::fail_with(console, done.error());
    console.out << "When dts-forward starts again, it offers all recordings and repeats all erasures\n";
    cli::print_hint(console, "systemctl restart dts-forward");
    return int{cli::kOk};
  });
}

cli::Manual make_manual() {
  return {.summary = "sends what a clinic records to one centre",
          .description =
              "Sends the recordings of\n.BR dtsd (8)\nto a centre, with what the clinic allows of each session, until the centre "
              "has a receipt for each. It changes nothing in the clinic: without a centre, everything works as before.",
          .environment = {{"DTSD_CONTROL, DTSD_DATA", "Addresses of the daemon's control and data sockets."},
                          {"DTSD_RUNTIME_DIR", "Directory of the daemon's sockets, control.sock and data.sock."}},
          .exit_statuses = {0, 1, 2, 4, 5, 6, 7},
          .further_sections = {},
          .files = {{"/etc/dtsd/forward.toml", "The configuration."},
                    {"/var/lib/dts-forward/sent.sqlite", "What the centre has, and which sessions it must erase. Do not delete it."}},
          .see_also = {{"dtsd", 8}, {"dtsctl", 1}, {"dts-hub", 8}}};
}

void add_commands(cli::CommandLine& line, Arguments& arguments) {
  CLI::App* run_app = cli::add_command(line, line.app, "run", "Send recordings to the centre until SIGTERM",
                                       "dts-forward run --config /etc/dtsd/forward.toml | as the service does\n",
                                       [&arguments](cli::Console& console) { return run_command(arguments, console); });
  CLI::App* key_app = cli::add_command(line, line.app, "key", "Make the clinic's key, if there is none, and print its public half",
                                       "dts-forward key --config /etc/dtsd/forward.toml | send the line to the centre\n",
                                       [&arguments](cli::Console& console) { return key_command(arguments, console); });
  CLI::App* status_app = cli::add_command(
      line, line.app, "status", "Show what waits, what is sent now, and why something is not sent",
      "dts-forward status --config /etc/dtsd/forward.toml | backlog, last receipt, time to go\n"
      "dts-forward status 4c1f3e0b5d7a9c2e4f6081a3b5c7d9ebfd0f21436587a9cbedff0123456789ab --config /etc/dtsd/forward.toml | exit status 0 "
      "only if there is a receipt; the centre is not asked\n",
      [&arguments](cli::Console& console) { return status_command(arguments, console); });
  status_app->add_option("sha256", arguments.sha256, "SHA-256 of a recording, as dtsctl session show prints it")->option_text("SHA256");
  status_app->add_flag("--json", arguments.is_json, "Print one JSON document");
  CLI::App* again_app = cli::add_command(
      line, line.app, "offer-again", "Offer all recordings again, and repeat all erasures: the centre was restored from a backup",
      "dts-forward offer-again --config /etc/dtsd/forward.toml | the centre answers at once for what it still has\n",
      [&arguments](cli::Console& console) { return offer_again_command(arguments, console); });
  for (CLI::App* command : {run_app, key_app, status_app, again_app}) {
    command->add_option("--config", arguments.file, "Configuration file")->required()->option_text("FILE");
  }
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  Arguments arguments;
  cli::CommandLine line({.name = "dts-forward",
                         .version = DTS_VERSION,
                         .description = "Sends what a clinic records to one centre",
                         .examples = "dts-forward key --config /etc/dtsd/forward.toml | once: the key that the centre needs\n"
                                     "dts-forward run --config /etc/dtsd/forward.toml | as the service does\n"
                                     "dts-forward status --config /etc/dtsd/forward.toml | what waits, and why\n"});
  add_commands(line, arguments);
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::fleet::forward
