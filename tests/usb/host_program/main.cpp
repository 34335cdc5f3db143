// SPDX-License-Identifier: Apache-2.0
// usb_emulator: a DAQ that is not there, on a bus that a daemon can use, wired to a simulated platform.
#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "usb/emulator/fs_plus_emulator.h"
#include "usb/host_program/bus.h"
#include "usb/host_program/commands.h"
#include "usb/host_program/emulated_daq.h"
#include "usb/host_program/rig_source.h"

namespace dts::emulator {
namespace {

struct Options {
  std::string bus;
  std::string device;
  std::string rig = "config/rigs/floor-sim.toml";
  std::string scene = "sim:floor?seed=7";
  std::string serial;
  std::string loop_back;  ///< "0:4"
  bool is_unplugged = false;
  std::vector<std::string> command;
};

int refuse(const core::Error& error) {
  std::cerr << "usb_emulator: " << core::to_string(error) << '\n';
  return error.code == core::ErrorCode::InvalidArgument ? 2 : 1;
}

pid_t start_child(const std::vector<std::string>& command, const std::vector<std::string>& environment, const sigset_t& signals) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  sigprocmask(SIG_UNBLOCK, &signals, nullptr);
  for (const std::string& variable : environment) ::putenv(const_cast<char*>(variable.c_str()));
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  ::execvp(arguments[0], arguments.data());
  std::cerr << "usb_emulator: cannot run " << command[0] << '\n';
  ::_exit(127);
}

/// Answers every whole line that has come; false: the input is over.
bool answer_lines(std::string& pending, Commands& commands) {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(STDIN_FILENO, bytes.data(), bytes.size());
  if (count <= 0) return false;
  pending.append(bytes.data(), static_cast<std::size_t>(count));
  for (std::size_t end = pending.find('\n'); end != std::string::npos; end = pending.find('\n')) {
    std::cout << commands.run(pending.substr(0, end)) << std::endl;
    pending.erase(0, end + 1);
  }
  return true;
}

/// Until the command ends, or without one until the input does; signals go to the command, and end the program when there is none.
int serve(Commands& commands, pid_t child, int signal_fd) {
  std::string pending;
  bool has_input = true;
  while (!commands.wants_to_quit() && (has_input || child > 0)) {
    std::array<pollfd, 2> waits{{{signal_fd, POLLIN, 0}, {has_input ? STDIN_FILENO : -1, POLLIN, 0}}};
    if (::poll(waits.data(), waits.size(), -1) < 0) continue;
    if (waits[1].revents != 0) has_input = answer_lines(pending, commands);
    signalfd_siginfo signal{};
    if (waits[0].revents == 0 || ::read(signal_fd, &signal, sizeof signal) != sizeof signal) continue;
    int status = 0;
    if (signal.ssi_signo == SIGCHLD && ::waitpid(child, &status, WNOHANG) == child)
      return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    if (signal.ssi_signo == SIGCHLD) continue;
    if (child <= 0) return 0;
    ::kill(child, static_cast<int>(signal.ssi_signo));
  }
  if (child <= 0) return 0;
  int status = 0;
  ::kill(child, SIGTERM);
  ::waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

int run(const Options& options) {
  sigset_t signals;  // before the first thread: all inherit it
  sigemptyset(&signals);
  for (const int number : {SIGCHLD, SIGTERM, SIGINT}) sigaddset(&signals, number);
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  const int signal_fd = ::signalfd(-1, &signals, SFD_CLOEXEC);

  std::unique_ptr<RigSource> rig;
  HeldInputs held;
  if (options.scene != "hold") {
    auto made = RigSource::create(options.rig, options.scene);
    if (!made) return refuse(made.error());
    rig = std::move(*made);
  }
  auto daq = create_daq(options.device, options.serial, rig ? rig->source() : held.source());
  if (!daq) return refuse(daq.error());
  if (!options.loop_back.empty()) {
    unsigned bit = 0;
    std::size_t input = 0;
    char colon = '\0';
    std::istringstream text(options.loop_back);
    const bool is_pair = (text >> bit >> colon >> input) && colon == ':' && text.eof();
    if (!is_pair || !daq->loop_back || bit >= 8 || input >= FsPlusEmulator::kInputs) {
      return refuse({core::ErrorCode::InvalidArgument, "--loop-back " + options.loop_back + ": not BIT:INPUT, or not with this DAQ", ""});
    }
    daq->loop_back(bit, input);
  }
  auto bus = create_bus(options.bus);
  if (!bus) return refuse(bus.error());
  if (!options.is_unplugged) {
    if (auto plugged = (*bus)->plug(*daq->device); !plugged) return refuse(plugged.error());
  }
  Commands commands(**bus, *daq, rig.get(), rig ? nullptr : &held);
  const pid_t child = options.command.empty() ? -1 : start_child(options.command, (*bus)->environment(), signals);
  const int status = serve(commands, child, signal_fd);
  (*bus)->unplug(*daq->device);
  return status;
}

}  // namespace
}  // namespace dts::emulator

int main(int argc, char** argv) {
  dts::emulator::Options options;
  CLI::App app{
      "usb_emulator - an emulated DAQ, its inputs wired to a simulated platform, on a bus that dtsd can use.\n\n"
      "Examples:\n"
      "  usb_emulator umockdev 1608fs-plus -- dtsd --config dtsd.toml    no root, no kernel module: only the command sees it\n"
      "  usb_emulator vhci 1608fs-plus                                   on this machine's kernel (root, modprobe vhci-hcd)\n\n"
      "Commands on standard input, one line each, answered by one line: plug, unplug, replug, fault NAME VALUE,\n"
      "truth [MONOTONIC_NS], story, hold VOLTS ..., quit."};
  app.add_option("BUS", options.bus, "umockdev or vhci")->required();
  app.add_option("DEVICE", options.device, "1608fs-plus, 1208fs-plus, 1408fs-plus, usb-201, usb-202, usb-204, usb-205, 1608g or u6")
      ->required();
  app.add_option("--rig", options.rig, "Rig file: plate and sensors")->capture_default_str();
  app.add_option("--scene", options.scene, "What is on the plate; hold: nothing, the inputs stay at what the command hold sets")
      ->capture_default_str();
  app.add_option("--serial", options.serial, "Serial number");
  app.add_option("--loop-back", options.loop_back, "Wire a digital output to an analogue input (not 1608g, u6)")->type_name("BIT:INPUT");
  app.add_flag("--unplugged", options.is_unplugged, "Plugged in only when asked for");
  app.add_option("COMMAND", options.command, "Run beside it; the program ends with its status");
  CLI11_PARSE(app, argc, argv);
  return dts::emulator::run(options);
}
