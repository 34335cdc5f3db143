// SPDX-License-Identifier: Apache-2.0
// dtsd: the daemon. Four switches; everything else is configuration (config/dtsd.toml) or a command (dtsctl).
#include <google/protobuf/stubs/logging.h>
#include <malloc.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>

#include "app/daemon.h"
#include "app/plate_check.h"
#include "core/process.h"
#include "device/usb/libusb_bus.h"

namespace {

constexpr int kBadInput = 2;
/// Bytes from which malloc(3) takes a block from the kernel and returns it there. 128 KiB is glibc's first value. glibc raises it when such
/// a block is freed: the large matrices of the start then leave free pages between used ones, and commands fill them for hours.
constexpr int kLargeBlock = 128 * 1024;

int report(const dts::files::Problems& problems) {
  for (const auto& problem : problems) std::cerr << dts::files::to_string(problem) << '\n';
  std::cerr << problems.size() << (problems.size() == 1 ? " problem" : " problems") << " found; nothing was started\n";
  return kBadInput;
}

int exit_status(const dts::core::Error& error) {
  switch (error.code) {
    case dts::core::ErrorCode::InvalidArgument: return kBadInput;
    case dts::core::ErrorCode::NotAllowed: return 4;
    case dts::core::ErrorCode::WrongState: return 6;
    default: return 1;
  }
}

int run(const std::string& file, bool is_check, bool is_foreground) {
  dts::app::LoadedConfig loaded = dts::app::load_config(file);
  dts::core::SystemClock clock;
  dts::core::Doorbell bell;
  if (is_foreground) ::unsetenv("JOURNAL_STREAM");
  const auto log = dts::core::Log::to_stderr(loaded.config.log_level);
  // All threads that start later inherit the cores, those of libraries too.
  auto notices = dts::core::configure_this_thread("dtsd", {.fifo_priority = 0, .cpus = loaded.config.realtime.cpus});
  // Its thread has a higher priority than the rigs' threads. It must outlive the rigs.
  dts::device::usb::LibusbBus usb(clock, loaded.config.realtime.policy(-1), log);
  auto rigs = dts::app::create_rigs(loaded.config, clock, bell, usb, log, loaded.problems);
  if (!loaded.problems.empty()) return report(loaded.problems);
  if (is_check) {
    for (const auto& warning : dts::app::plate_warnings(loaded.config)) std::cerr << "warning: " << dts::files::to_string(warning) << '\n';
    std::cout << file << ": fine, " << rigs.size() << " rig(s)\n";
    return 0;
  }
  dts::core::block_signals({SIGTERM, SIGINT, SIGHUP});  // the control thread polls for them
  dts::core::raise_descriptor_limit();
  const auto ended = dts::app::run_daemon(loaded.config, std::move(rigs), std::move(notices), clock, bell, usb, log);
  if (ended) return 0;
  log.error(dts::core::to_string(ended.error()));
  return exit_status(ended.error());
}

}  // namespace

int main(int argc, char** argv) {
  ::mallopt(M_MMAP_THRESHOLD, kLargeBlock);
  CLI::App app{
      "dtsd - the distributive tactile sensing daemon: samples rigs, computes, publishes.\n\n"
      "Examples:\n"
      "  dtsd --config config/dtsd.toml --check-config    report every problem in it\n"
      "  dtsd --config config/dtsd.toml                   run; control it with dtsctl"};
  std::string file;
  bool is_check = false;
  bool is_foreground = false;
  app.add_option("--config", file, "Configuration file")->required()->option_text("FILE");
  app.add_flag("--check-config", is_check, "Read the configuration and all files it names, report every problem, and exit");
  app.add_flag("--foreground", is_foreground, "Log to the terminal even when started by systemd");
  app.set_version_flag("--version", std::string(dts::app::version()));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }

  google::protobuf::SetLogHandler(nullptr);  // ControlServer counts and answers invalid messages; a flood of them must not fill the log
  try {
    return run(file, is_check, is_foreground);
  } catch (const std::exception& error) {  // no memory, descriptor or thread left
    std::cerr << "dtsd: " << error.what() << '\n';
    return 1;
  }
}
