// SPDX-License-Identifier: Apache-2.0
#include "usb/host_program/emulator_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace dts::emulator {
namespace {

std::filesystem::path make_directory() {
  std::string name = "/tmp/dts-usb-XXXXXX";  // short: a socket path has 107 bytes
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  return name;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  if (const std::size_t at = text.find(what); at != std::string::npos) text.replace(at, what.size(), by);
  return text;
}

}  // namespace

EmulatorProcess::EmulatorProcess(const Options& options) : directory_(make_directory()) {
  write_files(options);
  spawn(options);
  static_cast<void>(test::eventually([this] { return ctl({"status"}).status == 0; }));
}

EmulatorProcess::~EmulatorProcess() {
  if (pid_ > 0) static_cast<void>(quit());
  std::filesystem::remove_all(directory_);
}

void EmulatorProcess::write_files(const Options& options) const {
  const auto config = std::filesystem::path(DTS_SOURCE_DIR) / "config";
  std::filesystem::copy(config / "sensors", directory_ / "sensors");
  std::filesystem::create_directory(directory_ / "rigs");
  std::ifstream shipped(config / "rigs" / "floor-sim.toml");
  std::ofstream rig(directory_ / "rigs" / "floor.toml");
  rig << options.rig_text;
  if (!options.rig_text.empty()) shipped.setstate(std::ios::eofbit);
  for (std::string line; std::getline(shipped, line);) {
    if (!line.starts_with("calibration = ")) rig << line << '\n';  // weights have the point calibration
  }
  rig << "\n" << options.rig_tables;
  std::ofstream(directory_ / "weights.csv") << options.weights;
  std::ofstream(directory_ / "dtsd.toml") << "[[rig]]\nname = \"floor\"\nfile = \"rigs/floor.toml\"\ndevice = \"" << options.uri << "\"\n";
}

void EmulatorProcess::spawn(const Options& options) {
  std::array<int, 2> to{};
  std::array<int, 2> from{};
  if (::pipe2(to.data(), O_CLOEXEC) != 0 || ::pipe2(from.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  std::vector<std::string> arguments = {USB_EMULATOR_PROGRAM,
                                        "umockdev",
                                        options.daq,
                                        "--rig",
                                        directory_ / "rigs" / "floor.toml",
                                        "--scene",
                                        replaced(options.scene, "$DIR", directory_.string())};
  arguments.insert(arguments.end(), options.wiring.begin(), options.wiring.end());
  for (const std::string& argument : {std::string("--"), std::string(DTSD_PROGRAM), std::string("--config"),
                                      (directory_ / "dtsd.toml").string(), std::string("--foreground")}) {
    arguments.push_back(argument);
  }
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  pid_ = ::fork();
  if (pid_ == 0) {
    ::setenv("DTSD_RUNTIME_DIR", directory_.c_str(), 1);
    ::setenv("DTSD_STATE_DIR", (directory_ / "state").c_str(), 1);
    ::dup2(to[0], STDIN_FILENO);
    ::dup2(from[1], STDOUT_FILENO);
    ::dup2(::open((directory_ / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600), STDERR_FILENO);
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(to[0]);
  ::close(from[1]);
  commands_ = to[1];
  answers_ = from[0];
}

std::string EmulatorProcess::ask(const std::string& command) {
  const std::string line = command + "\n";
  if (::write(commands_, line.data(), line.size()) != static_cast<ssize_t>(line.size())) return {};
  std::string answer;
  for (char letter = 0; letter != '\n';) {
    pollfd waiter{.fd = answers_, .events = POLLIN, .revents = 0};
    if (::poll(&waiter, 1, 60'000) <= 0 || ::read(answers_, &letter, 1) != 1) return {};
    if (letter != '\n') answer += letter;
  }
  return answer;
}

std::optional<RigSource::Truth> EmulatorProcess::truth_at(std::int64_t monotonic_ns) {
  std::istringstream words(ask("truth " + std::to_string(monotonic_ns)));
  std::string ok;
  std::array<std::string, 3> numbers;  // "nan" is no number for a stream
  if (!(words >> ok >> numbers[0] >> numbers[1] >> numbers[2]) || ok != "ok") return std::nullopt;
  const auto number = [&](std::size_t i) { return std::strtod(numbers[i].c_str(), nullptr); };
  return RigSource::Truth{number(0), number(1), number(2)};
}

test::Finished EmulatorProcess::ctl(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), DTSCTL_PROGRAM);
  return test::run_program(arguments, {"DTSD_RUNTIME_DIR=" + directory_.string()});
}

client::Subscriber EmulatorProcess::subscribe(std::vector<std::string> topics) const {
  const std::string endpoint = "ipc://" + (directory_ / "data.sock").string();
  return client::Subscriber::open({.endpoint = endpoint, .topics = std::move(topics), .mode = client::Mode::All}).value();
}

bool EmulatorProcess::is_streaming() const { return ctl({"status", "--json"}).out.find("\"device\": \"streaming\"") != std::string::npos; }

std::string EmulatorProcess::log() const {
  std::stringstream text;
  text << std::ifstream(directory_ / "log").rdbuf();
  return text.str();
}

int EmulatorProcess::quit() {
  ::close(commands_);
  ::kill(pid_, SIGTERM);
  int raw = 0;
  ::waitpid(pid_, &raw, 0);
  ::close(answers_);
  pid_ = -1;
  return WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw);
}

}  // namespace dts::emulator
