// SPDX-License-Identifier: Apache-2.0
#include "system/daemon_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "system/notify_socket.h"

extern char** environ;

namespace dts::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Starts a program with stdout and stderr into files ("" = /dev/null).
pid_t spawn(const std::vector<std::string>& arguments, const std::vector<std::string>& environment, const std::string& out,
            const std::string& err) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::vector<char*> envp;
  for (const std::string& variable : environment) envp.push_back(const_cast<char*>(variable.c_str()));
  for (char** inherited = environ; *inherited != nullptr; ++inherited) {
    if (std::strncmp(*inherited, "DTSD_", 5) != 0 && std::strncmp(*inherited, "NOTIFY_SOCKET=", 14) != 0) envp.push_back(*inherited);
  }
  envp.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  const int out_fd = ::open(out.empty() ? "/dev/null" : out.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  const int err_fd = ::open(err.empty() ? "/dev/null" : err.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::dup2(out_fd, STDOUT_FILENO);
  ::dup2(err_fd, STDERR_FILENO);
  ::execve(argv[0], argv.data(), envp.data());
  ::_exit(127);
}

int exit_status(int raw) { return WIFSIGNALED(raw) ? 128 + WTERMSIG(raw) : WEXITSTATUS(raw); }

/// Waits for a child; kills it when it takes longer than kPatience.
int reap(pid_t pid) {
  int raw = 0;
  const auto deadline = Clock::now() + kPatience;
  while (::waitpid(pid, &raw, WNOHANG) == 0) {
    if (Clock::now() > deadline) ::kill(pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return exit_status(raw);
}

std::filesystem::path make_directory(const char* pattern) {
  std::string name = std::string("/tmp/") + pattern + "-XXXXXX";  // short: a socket path has 107 bytes
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary directory");
  return name;
}

constexpr const char* kDefaultStages =
    "[[stage]]\nid = \"guard\"\n[[stage]]\nid = \"window_filter\"\n[[stage]]\nid = \"linearise\"\n[[stage]]\nid = \"cop\"\n";

/// The shipped rig file with the parts replaced that `rig` names.
std::string adapted(std::string text, const DaemonProcess::FurtherRig& rig) {
  const auto cut = [&text](const std::string& from, const std::string& to, const std::string& replacement) {
    const std::size_t begin = text.find(from);
    const std::size_t end = text.find(to, begin);
    if (begin == std::string::npos || end == std::string::npos) throw std::runtime_error("the shipped rig file has changed: " + from);
    text.replace(begin, end - begin, replacement);
  };
  if (!rig.acquire.empty()) cut("[acquire]", "[[sensor]]", "[acquire]\n" + rig.acquire + "\n");
  if (text.find("\ncalibration = ") != std::string::npos) cut("calibration = ", "\n", "");  // tests use the point calibration
  const bool is_floor = rig.file == "floor-sim.toml";
  if (is_floor || !rig.stages.empty()) cut("[[stage]]", "[publish]", rig.stages.empty() ? kDefaultStages : rig.stages + "\n");
  return text;
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

bool eventually(const std::function<bool()>& condition) {
  const auto deadline = Clock::now() + kPatience;
  while (Clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return condition();
}

Finished run_program(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  const auto directory = make_directory("dts-run");
  const pid_t pid = spawn(arguments, environment, directory / "out", directory / "err");
  Finished finished{.status = reap(pid), .out = {}, .err = {}};
  finished.out = read_file(directory / "out");
  finished.err = read_file(directory / "err");
  std::filesystem::remove_all(directory);
  return finished;
}

ServiceProcess::ServiceProcess(const std::vector<std::string>& arguments, std::vector<std::string> environment,
                               const std::filesystem::path& log, const std::filesystem::path& notify) {
  const NotifySocket socket(notify);
  environment.push_back("NOTIFY_SOCKET=" + notify.string());
  pid_ = spawn(arguments, environment, "", log);
  static_cast<void>(eventually([&] {
    is_ready_ = is_ready_ || socket.says_ready(20);
    int raw = 0;
    if (!is_ready_ && ::waitpid(pid_, &raw, WNOHANG) == pid_) exit_status_ = exit_status(raw);
    return is_ready_ || exit_status_.has_value();
  }));
}

bool ServiceProcess::is_running() const { return !exit_status_ && ::kill(pid_, 0) == 0; }

void ServiceProcess::signal(int number) const {
  if (!exit_status_) ::kill(pid_, number);
}

int ServiceProcess::wait() {
  if (!exit_status_) exit_status_ = reap(pid_);
  return *exit_status_;
}

DaemonProcess::DaemonProcess() : DaemonProcess(Options{}) {}

DaemonProcess::DaemonProcess(const Options& options) : program_(options.program), directory_(make_directory("dts-sys")) {
  write_files(options);
  restart();
}

DaemonProcess::~DaemonProcess() {
  if (is_running()) {
    signal(SIGTERM);
    static_cast<void>(wait());
  }
  std::filesystem::remove_all(directory_);
}

void DaemonProcess::write_files(const Options& options) const {
  const auto source = std::filesystem::path(DTS_SOURCE_DIR) / "config";
  for (const char* folder : {"sensors", "models"}) std::filesystem::copy(source / folder, directory_ / folder);
  std::filesystem::create_directory(directory_ / "rigs");
  std::vector<FurtherRig> rigs{{.name = "floor", .device = options.device, .acquire = options.acquire, .stages = options.stages}};
  rigs.insert(rigs.end(), options.further_rigs.begin(), options.further_rigs.end());
  std::ofstream daemon_file(config_file());
  daemon_file << options.daemon << "\n";
  for (const FurtherRig& rig : rigs) {
    const std::string file = "rigs/" + rig.name + ".toml";
    std::ofstream(directory_ / file) << adapted(read_file(source / "rigs" / rig.file), rig);
    daemon_file << "[[rig]]\nname = \"" << rig.name << "\"\nfile = \"" << file << "\"\ndevice = \"" << rig.device << "\"\n";
  }
}

void DaemonProcess::restart() {
  process_.emplace(std::vector<std::string>{program_, "--config", config_file(), "--foreground"}, environment(), directory_ / "log",
                   directory_ / "notify");
}

std::vector<std::string> DaemonProcess::environment() const {
  return {"DTSD_RUNTIME_DIR=" + directory_.string(), "DTSD_STATE_DIR=" + state_directory().string()};
}

std::string DaemonProcess::log() const { return read_file(directory_ / "log"); }

client::ControlClient DaemonProcess::control() const {
  return client::ControlClient::open({.endpoint = control_endpoint(), .timeout = std::chrono::seconds(60)}).value();
}

client::Subscriber DaemonProcess::subscribe(std::vector<std::string> topics, client::Mode mode) const {
  return client::Subscriber::open({.endpoint = data_endpoint(), .topics = std::move(topics), .mode = mode}).value();
}

Finished DaemonProcess::ctl(std::vector<std::string> arguments) const {
  arguments.insert(arguments.begin(), DTSCTL_PROGRAM);
  return run_program(arguments, {"DTSD_RUNTIME_DIR=" + directory_.string()});
}

long resident_kb(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) return std::stol(line.substr(6));
  }
  return 0;
}

}  // namespace dts::test
