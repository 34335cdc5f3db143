// SPDX-License-Identifier: Apache-2.0
#include "lsl/lsl_system.h"

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "support/temporary_folder.h"

namespace dts::test {
void isolate_lsl() {
  static const TemporaryFolder folder;
  const std::string file = folder.path() + "/lsl_api.cfg";
  std::ofstream(file) << "[lab]\nSessionID = dts-" << ::getpid() << "\nKnownPeers = {127.0.0.1}\n[multicast]\nResolveScope = machine\n"
                      << "[ports]\nIPv6 = disable\n[log]\nlevel = -3\n";
  if (!std::filesystem::exists(file)) throw std::runtime_error("cannot write " + file);
  ::unsetenv("LSLAPICFG");
  std::filesystem::current_path(folder.path());
}

LslProcess::LslProcess(const DaemonProcess& daemon, const std::string& lines, const std::string& tables) : daemon_(daemon) {
  std::ofstream(daemon.directory() / "lsl.toml") << "[lsl]\nlibrary = \"" << liblsl_file() << "\"\n" << lines << "\n" << tables << "\n";
  start();
}

LslProcess::~LslProcess() {
  if (is_running()) static_cast<void>(end(SIGTERM));
}

void LslProcess::start() {
  process_.emplace(std::vector<std::string>{DTS_LSL_PROGRAM, "--config", (daemon_.directory() / "lsl.toml").string()},
                   daemon_.environment(), daemon_.directory() / "lsl.log", daemon_.directory() / "lsl-notify");
}

int LslProcess::end(int signal) {
  process_->signal(signal);
  return process_->wait();
}

std::string LslProcess::log() const { return read_file(daemon_.directory() / "lsl.log"); }

bool is_connected(const DaemonProcess& daemon, Inlet& events) {
  auto control = daemon.control();
  const bool has_arrived = eventually([&] { return control.mark("connect", "") && events.pull_text(0.5); });
  if (!has_arrived || !control.mark("connected", "")) return false;
  return eventually([&events] {
    const auto event = events.pull_text(0.1);
    return event && event->text.find("\"connected\"") != std::string::npos;
  });
}

Finished run_lsl(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  std::vector<std::string> words{DTS_LSL_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return run_program(words, environment);
}

}  // namespace dts::test
