// SPDX-License-Identifier: Apache-2.0
#include "gateway/program.h"

#include <unistd.h>

#include "cli/command_line.h"
#include "cli/run.h"
#include "gateway/access/user_commands.h"
#include "gateway/config_file.h"
#include "gateway/gateway.h"
#include "gateway/options.h"

namespace dts::gateway {
namespace {

void add_serve(cli::CommandLine& line, Options& options) {
  CLI::App* serve_command =
      cli::add_command(line, line.app, "serve", "Serve the dashboard to browsers until Ctrl-C",
                       "dts-gateway serve | on this machine only, without a login: http://127.0.0.1:8080/\n"
                       "dts-gateway serve --local-role viewer | the same, but browsers can only look\n"
                       "dts-gateway serve --listen 192.168.1.20:8443 --tls-certificate clinic.pem --tls-key clinic.key --users users | to "
                       "tablets, with a login\n",
                       [&options](cli::Console& console) { return serve(options, console); });
  add_server_options(*serve_command, options);
  serve_command
      ->add_option("--cache", options.cache_directory, "Folder for exports; the gateway uses and empties only dts-gateway-exports in it")
      ->option_text("DIR");
  serve_command->add_option("--metrics", options.has_metrics, "Counters for Prometheus under /metrics: true or false. Default: true")
      ->option_text("BOOL");
  serve_command->add_option("--endpoint", options.control_endpoint, "Control address of the daemon")->option_text("URI");
  serve_command->add_option("--data", options.data_endpoint, "Data address; default: the data socket beside the control socket")
      ->option_text("URI");
}

cli::Manual make_manual() {
  return {
      .summary = "browser dashboard of the distributive tactile sensing daemon",
      .description =
          "Serves the dashboard and passes live data of\n.BR dtsd (8)\nto browsers, and commands of users with the necessary role to it.",
      .environment = {{"DTSD_CONTROL, DTSD_DATA", "Addresses of the daemon's control and data sockets."},
                      {"DTSD_RUNTIME_DIR", "Directory of the daemon's sockets, control.sock and data.sock."},
                      {"CACHE_DIRECTORY", "Folder for exports, as systemd sets it."}},
      .exit_statuses = {0, 1, 2, 5, 6, 130},
      .further_sections = {},
      .files = {{"/usr/share/dts-gateway/web", "The dashboard."}},
      .see_also = {{"dtsd", 8}, {"dtsctl", 1}}};
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  Options options;
  cli::CommandLine line({.name = "dts-gateway",
                         .version = DTS_VERSION,
                         .description = "The browser dashboard of dtsd",
                         .examples = "dts-gateway serve | then open http://127.0.0.1:8080/\n"
                                     "dts-gateway user add anna --role operator --users users | asks for the password\n"});
  line.app.allow_config_extras(CLI::config_extras_mode::error);  // a misspelt key in [serve] must not silently select the default
  line.app.set_config("--config", "", "Read options from a TOML file; options of serve are in its table [serve]")
      ->option_text("FILE")
      ->check([&app = line.app](const std::string& file) { return problem_of_config(file, app); });
  add_serve(line, options);
  add_user_commands(line, [](cli::Console& talk) { return ask_password(STDIN_FILENO, talk); });
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::gateway
