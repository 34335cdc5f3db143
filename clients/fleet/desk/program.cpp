// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/program.h"

#include "cli/command_line.h"
#include "cli/run.h"
#include "fleet/desk/serve.h"

namespace dts::fleet::desk {
namespace {

void add_serve(cli::CommandLine& line, Options& options) {
  CLI::App* serve_command =
      cli::add_command(line, line.app, "serve", "Serve the dashboard of the centre to browsers until Ctrl-C",
                       "dts-fleet-gateway serve --config hub.toml | on this machine only, without a login: http://127.0.0.1:8080/\n"
                       "dts-fleet-gateway serve --config hub.toml --listen 192.168.1.20:8443 --tls-certificate centre.pem --tls-key "
                       "centre.key --users users "
                       "| to other machines, with a login\n",
                       [&options](cli::Console& console) { return serve(options, console); });
  serve_command->add_option("--config", options.config, "Configuration of the hub: nats-server and PostgreSQL")
      ->option_text("FILE")
      ->required();
  gateway::add_server_options(*serve_command, options.server);
}

cli::Manual make_manual() {
  return {.summary = "browser dashboard of a fleet",
          .description =
              "Serves the dashboard of the centre: the clinics of a fleet, their sessions, and live data of their rigs.\nIt reads "
              "PostgreSQL and nats-server as\n.BR dts-hub (8)\ndoes, and changes nothing.",
          .environment = {},
          .exit_statuses = {0, 1, 2, 130},
          .further_sections = {},
          .files = {{"/etc/dts-hub/hub.toml", "Configuration of the hub."}, {"/usr/share/dts-gateway/web", "The dashboard."}},
          .see_also = {{"dts-hub", 8}, {"dts-gateway", 1}}};
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  Options options;
  cli::CommandLine line({.name = "dts-fleet-gateway",
                         .version = DTS_VERSION,
                         .description = "The browser dashboard of a fleet",
                         .examples = "dts-fleet-gateway serve --config hub.toml | then open http://127.0.0.1:8080/\n"
                                     "dts-gateway user add anna --role viewer --users users | adds a user for --users\n"});
  add_serve(line, options);
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::fleet::desk
