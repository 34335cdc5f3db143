// SPDX-License-Identifier: Apache-2.0
#include "fleet/desk/program.h"

#include "cli/command_line.h"
#include "cli/exit_status.h"
#include "cli/run.h"
#include "fleet/desk/serve.h"
#include "fleet/wire/nkey.h"
#include "gateway/config_file.h"

namespace dts::fleet::desk {
namespace {

void add_serve(cli::CommandLine& line, Options& options) {
  CLI::App* serve_command = cli::add_command(line, line.app, "serve", "Serve the dashboard of the centre to browsers until Ctrl-C",
                                             "dts-fleet-gateway serve --config gateway.toml | as the service does\n",
                                             [&options](cli::Console& console) { return serve(options, console); });
  serve_command->add_option("--nats-server", options.nats_servers, "Address of nats-server; may be repeated")
      ->option_text("URL")
      ->required();
  serve_command->add_option("--nats-ca", options.nats_ca_file, "PEM file with the authority that signed nats-server's certificate")
      ->option_text("FILE");
  serve_command->add_option("--nats-key", options.nats_key_file, "Key for nats-server, made by `dts-fleet-gateway key`")
      ->option_text("FILE")
      ->required();
  serve_command->add_option("--database", options.database, "Connection to PostgreSQL; its role needs to read only")
      ->option_text("TEXT")
      ->required();
  gateway::add_server_options(*serve_command, options.server);
}

int print_key(const std::string& file, cli::Console& console) {
  const auto key = wire::read_or_create_nkey(file);
  if (!key) return cli::fail_with(console, key.error());
  console.out << key->public_key << '\n';
  cli::print_hint(console, "let it in: key = \"" + key->public_key + "\" below [[dashboard]] in hub.toml, then restart dts-hub");
  return cli::kOk;
}

void add_key(cli::CommandLine& line, Options& options) {
  cli::add_command(line, line.app, "key", "Make the key for nats-server, if there is none, and print its public half",
                   "dts-fleet-gateway key --nats-key /var/lib/dts-fleet-gateway/dashboard.nk | the line belongs into hub.toml\n",
                   [&options](cli::Console& console) { return print_key(options.nats_key_file, console); })
      ->add_option("--nats-key", options.nats_key_file, "File of the key")
      ->option_text("FILE")
      ->required();
}

cli::Manual make_manual() {
  return {.summary = "browser dashboard of a fleet",
          .description =
              "Serves the dashboard of the centre: the clinics of a fleet, their sessions, and live data of their rigs.\nIt reads the "
              "database of\n.BR dts-hub (8)\nand live data of nats-server, with rights of its own, and changes nothing.",
          .environment = {},
          .exit_statuses = {0, 1, 2, 4, 5, 130},
          .further_sections = {},
          .files = {{"/etc/dts-fleet-gateway/gateway.toml", "Configuration."}, {"/usr/share/dts-gateway/web", "The dashboard."}},
          .see_also = {{"dts-hub", 8}, {"dts-gateway", 8}}};
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  Options options;
  options.server.listen = "127.0.0.1:8081";  // 8080 is that of dts-gateway
  cli::CommandLine line({.name = "dts-fleet-gateway",
                         .version = DTS_VERSION,
                         .description = "The browser dashboard of a fleet",
                         .examples = "dts-fleet-gateway serve --config gateway.toml | then open http://127.0.0.1:8081/\n"
                                     "dts-gateway user add anna --role viewer --users users | adds a user for --users\n"});
  line.app.allow_config_extras(CLI::config_extras_mode::error);  // a misspelt key in [serve] must not silently select the default
  line.app.set_config("--config", "", "Read options from a TOML file; options of serve are in its table [serve]")
      ->option_text("FILE")
      ->check([&app = line.app](const std::string& file) { return gateway::problem_of_config(file, app); });
  add_serve(line, options);
  add_key(line, options);
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::fleet::desk
