// SPDX-License-Identifier: Apache-2.0
// dts-relay: the network side of dtsd. Its configuration is dtsd's (config/dtsd.toml, [network]).
#include <signal.h>
#include <systemd/sd-daemon.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "core/process.h"
#include "relay/relay.h"

namespace {

constexpr int kBadInput = 2;

int report(const dts::files::Problems& problems) {
  for (const auto& problem : problems) std::cerr << dts::files::to_string(problem) << '\n';
  return kBadInput;
}

int exit_status(const dts::core::Error& error) {
  switch (error.code) {
    case dts::core::ErrorCode::InvalidArgument: return kBadInput;
    case dts::core::ErrorCode::NotAllowed: return 4;
    case dts::core::ErrorCode::NotFound: return 5;
    default: return 1;
  }
}

int run(const std::string& file) {
  dts::files::Problems problems;
  const dts::relay::Settings settings = dts::relay::load_settings(file, problems);
  if (!problems.empty()) return report(problems);
  const auto log = dts::core::Log::to_stderr(settings.log_level);
  if (!settings.network) {
    sd_notify(0, "READY=1");  // systemd takes an end before this for a failure
    log.info(file + " has no [network]: dtsd serves this machine only, and there is nothing to relay");
    return 0;
  }
  dts::core::block_signals({SIGTERM, SIGINT});
  dts::core::raise_descriptor_limit();
  dts::core::SystemClock clock;
  const auto ended = dts::relay::run_relay(settings, clock, log);
  if (ended) return 0;
  log.error(dts::core::to_string(ended.error()));
  return exit_status(ended.error());
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{
      "dts-relay - connects other machines with dtsd: clients with keys, over CURVE.\n\n"
      "Example:\n"
      "  dts-relay --config /etc/dtsd/dtsd.toml    the file of dtsd, which has the addresses in [network]"};
  std::string file;
  app.add_option("--config", file, "Configuration file of dtsd")->required()->option_text("FILE");
  app.set_version_flag("--version", DTS_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  try {
    return run(file);
  } catch (const std::exception& error) {  // no memory, descriptor or thread left
    std::cerr << "dts-relay: " << error.what() << '\n';
    return 1;
  }
}
