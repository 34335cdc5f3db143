// SPDX-License-Identifier: Apache-2.0
#include <signal.h>

#include "cli/exit_status.h"
#include "cli/run.h"
#include "core/clock.h"
#include "core/process.h"
#include "fleet/database/schema.h"
#include "fleet/hub/erasures.h"
#include "fleet/hub/hub.h"
#include "fleet/hub/programs.h"
#include "fleet/hub/rebuild.h"

namespace dts::fleet::hub {
namespace {

using database::Database;
using database::migrate;

constexpr const char* kDefaultConfig = "/etc/dts-hub/hub.toml";

int run_command(const std::string& file, cli::Console& console) {
  const auto settings = settings_of(file, console);
  if (!settings) return cli::kUsage;
  core::block_signals({SIGTERM, SIGINT});
  const auto log = core::Log::to_stderr(settings->log_level);
  core::SystemClock clock;
  const auto ended = run_hub(*settings, clock, log);
  return ended ? cli::kOk : cli::fail_with(console, ended.error());
}

int rebuild_command(const std::string& file, cli::Console& console) {
  const auto settings = settings_of(file, console);
  if (!settings) return cli::kUsage;
  Database database({.connection = settings->connection, .name = "dts-hub rebuild"});
  if (const auto migrated = migrate(database); !migrated) return cli::fail_with(console, migrated.error());
  const auto store = open_store(*settings);
  if (!store) return cli::fail_with(console, store.error());
  Catalogue catalogue(database);
  const core::SystemClock clock;
  const std::int64_t utc_ns = clock.now_ns() + clock.utc_minus_monotonic_ns();
  Erasures erasures(catalogue, **store, ErasureJournal(settings->directory));
  const auto reconciled = erasures.reconcile(utc_ns);
  if (!reconciled) return cli::fail_with(console, reconciled.error());
  const auto removed = erasures.remove_left("");
  if (!removed) return cli::fail_with(console, removed.error());
  const auto rebuilt = rebuild(**store, catalogue, settings->name, utc_ns);
  if (!rebuilt) return cli::fail_with(console, rebuilt.error());
  for (const std::string& left : rebuilt->left) cli::print_error(console, left, "the recording stays in the store, without a row");
  console.out << count_text(rebuilt->entered, "recording") << " entered, " << rebuilt->known << " known before, " << rebuilt->left.size()
              << " left\n"
              << count_text(*reconciled, "session") << " erased again, " << count_text(*removed + rebuilt->erased, "recording")
              << " of erased sessions removed\n";
  if (!rebuilt->clinics.empty()) {
    cli::print_hint(console, "add the clinics again, with their keys (dts-fleet clinic add): " +
                                 cli::join(std::vector<std::string>(rebuilt->clinics.begin(), rebuilt->clinics.end()), ", "));
  }
  return rebuilt->left.empty() ? cli::kOk : cli::exit_status(core::ErrorCode::DataDamaged);
}

/// A command line with the option that all its commands share.
struct HubLine : cli::CommandLine {
  using cli::CommandLine::CommandLine;
  std::string config = kDefaultConfig;
};

}  // namespace

void add_config_option(cli::CommandLine& line, std::string& file) {
  file = kDefaultConfig;
  line.app.add_option("--config", file, std::string("Configuration of the centre. Default: ") + kDefaultConfig)->option_text("FILE");
}

std::optional<Settings> settings_of(const std::string& file, cli::Console& console) {
  files::Problems problems;
  Settings settings = load_settings(file, problems);
  if (problems.empty()) return settings;
  for (const files::Problem& problem : problems) cli::print_error(console, files::to_string(problem));
  return std::nullopt;
}

std::shared_ptr<cli::CommandLine> make_hub_tree() {
  auto line = std::make_shared<HubLine>(cli::Program{.name = "dts-hub",
                                                     .version = DTS_VERSION,
                                                     .description = "Receives and keeps what the clinics of a fleet record",
                                                     .examples = "dts-hub run --config hub.toml | serve the clinics\n"
                                                                 "dts-hub rebuild --config hub.toml | after a loss of the database\n"});
  add_config_option(*line, line->config);
  const std::string& config = line->config;
  cli::add_command(*line, line->app, "run", "Serve the clinics until SIGTERM or Ctrl-C",
                   "dts-hub run --config hub.toml | with the database and the folder that the file names\n",
                   [&config](cli::Console& console) { return run_command(config, console); });
  cli::add_command(*line, line->app, "rebuild", "Enter stored recordings that are missing in the database",
                   "dts-hub rebuild --config hub.toml | reads and checks each of them\n",
                   [&config](cli::Console& console) { return rebuild_command(config, console); });
  cli::add_common(*line);
  line->manual = {.summary = "centre of a fleet of clinics",
                  .description =
                      "Receives recordings and facts from\n.BR dts-forward (8)\nof each clinic through nats-server, keeps the "
                      "recordings in a folder and their catalogue in PostgreSQL.",
                  .environment = {},
                  .exit_statuses = {0, 1, 2, 3, 4, 5, 7, 130},
                  .further_sections = {},
                  .files = {{kDefaultConfig, "Configuration."}},
                  .see_also = {{"dts-fleet", 1}, {"dts-forward", 8}}};
  return line;
}

int run_hub_program(const std::vector<std::string>& words, cli::Console& console) {
  const auto line = make_hub_tree();
  return cli::run(*line, words, console);
}

}  // namespace dts::fleet::hub
