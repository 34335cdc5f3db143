// SPDX-License-Identifier: Apache-2.0
#include "gateway/gateway_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace dts::test {
namespace {

std::filesystem::path make_directory() {
  char name[] = "/tmp/dts-XXXXXX";
  if (::mkdtemp(name) == nullptr) throw std::runtime_error("no temporary directory");
  return name;
}

pid_t spawn(std::vector<std::string> words, const std::string& runtime_directory, const std::filesystem::path& directory) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const pid_t pid = ::fork();
  if (pid != 0) return pid;
  const int output = ::open((directory / "log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(output, STDERR_FILENO);
  ::setenv("DTSD_RUNTIME_DIR", runtime_directory.c_str(), 1);
  ::setenv("TMPDIR", (directory / "tmp").c_str(), 1);
  ::unsetenv("CACHE_DIRECTORY");
  ::signal(SIGHUP, SIG_DFL);  // whoever runs the tests may have it ignored
  ::execv(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

GatewayProcess::GatewayProcess(const DaemonProcess& daemon, const std::vector<std::string>& options) : directory_(make_directory()) {
  std::filesystem::create_directory(directory_ / "web");
  std::ofstream(directory_ / "web/index.html") << "<!doctype html><title>dashboard</title>\n";
  std::filesystem::create_directory(directory_ / "tmp");
  std::vector<std::string> words{DTS_GATEWAY_PROGRAM, "serve", "--listen", "127.0.0.1:0", "--web-root", (directory_ / "web").string()};
  words.insert(words.end(), options.begin(), options.end());
  pid_ = spawn(words, daemon.directory().string(), directory_);
  static_cast<void>(eventually([&] {
    const std::string said = log();
    const std::string before = "listening on http://127.0.0.1:";
    const std::size_t at = said.find(before);
    const bool is_ready = at != std::string::npos && said.find('\n', at) != std::string::npos;
    if (is_ready) port_ = static_cast<std::uint16_t>(std::stoul(said.substr(at + before.size())));
    return is_ready || !is_running();
  }));
}

GatewayProcess::~GatewayProcess() {
  static_cast<void>(stop());
  if (is_running()) ::kill(pid_, SIGKILL);
  std::filesystem::remove_all(directory_);
}

bool GatewayProcess::is_running() const { return ::waitpid(pid_, nullptr, WNOHANG) == 0; }

int GatewayProcess::stop(int signal) {
  if (!is_running()) return -1;
  ::kill(pid_, signal);
  int status = 0;
  pid_t ended = 0;
  static_cast<void>(eventually([&] {
    ended = ::waitpid(pid_, &status, WNOHANG);
    return ended != 0;
  }));
  return ended == pid_ && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string GatewayProcess::log() const {
  std::ifstream file(directory_ / "log");
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

ScanWatch::ScanWatch(const DaemonProcess& daemon)
    : thread_([this, subscriber = daemon.subscribe({"floor/cop"})](const std::stop_token& stop) mutable {
        bool is_first = true;
        while (!stop.stop_requested()) {
          const auto message = subscriber.receive(std::chrono::milliseconds(50));
          const auto* block = message && *message ? std::get_if<client::Block>(&**message) : nullptr;
          if (block == nullptr) continue;
          if (!is_first) count_.lost += block->lost_scans;  // what came before the formats were known says nothing
          is_first = false;
          count_.scans += block->scan_count;
          count_.gaps = block->segment + block->lost_before_pipeline_total + block->dropped_blocks_total;
        }
      }) {}

ScanWatch::Count ScanWatch::stop() {
  thread_.request_stop();
  thread_.join();
  return count_;
}

}  // namespace dts::test
