// SPDX-License-Identifier: Apache-2.0
#include "fleet/worker/program.h"

#include <signal.h>

#include "cli/command_line.h"
#include "cli/exit_status.h"
#include "cli/run.h"
#include "core/log.h"
#include "core/process.h"
#include "fleet/worker/settings.h"
#include "fleet/worker/worker.h"

namespace dts::fleet::worker {
namespace {

int run_with(const std::string& file, cli::Console& console) {
  files::Problems problems;
  const WorkerOptions options = read_settings(file, problems);
  for (const files::Problem& problem : problems) cli::print_error(console, files::to_string(problem));
  if (!problems.empty()) return cli::kUsage;
  core::block_signals({SIGTERM, SIGINT});
  const auto ended = run_worker(options, core::Log::to_stderr(core::LogLevel::Info));
  return ended ? cli::kOk : cli::fail_with(console, ended.error());
}

cli::Manual make_manual() {
  return {.summary = "runs analyses of recordings at the centre of a fleet",
          .description =
              "Takes jobs from the database of\n.BR dts-hub (8)\nand executes\n.BR dtslab (1)\non recordings of its store. Any number "
              "of workers may run, on any machine that reaches both. The results are written beside those of the clinics.",
          .environment = {{"TMPDIR", "Folder for the names that recordings have while dtslab reads them."}},
          .exit_statuses = {0, 1, 2, 4, 5},
          .further_sections = {},
          .files = {{"/etc/dtsd/worker.toml", "The configuration: database, store, dtslab, limits."}},
          .see_also = {{"dts-hub", 8}, {"dtslab", 1}}};
}

}  // namespace

int run(const std::vector<std::string>& words, cli::Console& console) {
  std::string file;
  cli::CommandLine line({.name = "dts-worker",
                         .version = DTS_VERSION,
                         .description = "Runs analyses of recordings at the centre of a fleet",
                         .examples = "dts-worker run --config /etc/dtsd/worker.toml | takes jobs until Ctrl-C\n"});
  CLI::App* const command = cli::add_command(line, line.app, "run", "Take jobs and run dtslab for them, until Ctrl-C",
                                             "dts-worker run --config /etc/dtsd/worker.toml | jobs are added with dts-fleet jobs add\n",
                                             [&file](cli::Console& talk) { return run_with(file, talk); });
  command->add_option("--config", file, "Configuration file")->required()->option_text("FILE");
  cli::add_common(line);
  line.manual = make_manual();
  return cli::run(line, words, console);
}

}  // namespace dts::fleet::worker
