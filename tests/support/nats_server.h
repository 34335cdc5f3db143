// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "support/temporary_folder.h"

namespace dts::test {

/// A real nats-server on a free port of 127.0.0.1, which ends with this object or with the test. Its log is in `folder()/nats.log`.
class NatsServer {
 public:
  /// Returns the path of the program, or nothing if it is not installed: then the test is skipped.
  [[nodiscard]] static std::optional<std::string> program() {
    for (const char* const path : {"/usr/sbin/nats-server", "/usr/bin/nats-server", "/usr/local/bin/nats-server"}) {
      if (::access(path, X_OK) == 0) return path;
    }
    return std::nullopt;
  }

  /// `settings`: more lines of its configuration. Throws if it does not start.
  explicit NatsServer(const std::string& settings = {}) { start(settings); }
  ~NatsServer() { kill(); }
  NatsServer(const NatsServer&) = delete;
  NatsServer& operator=(const NatsServer&) = delete;

  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  /// Starts it again on the same port.
  void start(const std::string& settings = {}) {
    kill();
    const std::string ports = folder_.path() + "/ports";
    std::filesystem::remove_all(ports);
    std::filesystem::create_directory(ports);
    const std::string file = folder_.path() + "/nats.conf";
    std::ofstream(file) << "listen: \"127.0.0.1:" << (port_ == 0 ? -1 : port_) << "\"\nports_file_dir: \"" << ports << "\"\n"
                        << settings << '\n';
    const std::string log = folder_.path() + "/nats.log";
    pid_ = ::fork();
    if (pid_ < 0) throw std::runtime_error("cannot fork");
    if (pid_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      ::execl(program()->c_str(), "nats-server", "-c", file.c_str(), "-l", log.c_str(), static_cast<char*>(nullptr));
      ::_exit(127);
    }
    for (int tries = 0; tries < 1000; ++tries) {
      for (const auto& entry : std::filesystem::directory_iterator(ports)) {
        if (const int found = port_in(entry.path()); found > 0) {
          port_ = found;
          return;
        }
      }
      if (::waitpid(pid_, nullptr, WNOHANG) == pid_) {
        pid_ = 0;
        throw std::runtime_error("nats-server ended: " + log_text());
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw std::runtime_error("nats-server does not start: " + log_text());
  }
  void reload(const std::string& settings) {
    std::ofstream(folder_.path() + "/nats.conf") << "listen: \"127.0.0.1:" << port_ << "\"\n" << settings << '\n';
    ::kill(pid_, SIGHUP);
  }

  [[nodiscard]] int port() const noexcept { return port_; }
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  [[nodiscard]] const std::string& folder() const noexcept { return folder_.path(); }
  [[nodiscard]] std::string log_text() const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() + "/nats.log").rdbuf();
    return text.str();
  }

 private:
  /// The file is {"nats":["nats://127.0.0.1:12345"]}; 0: it is not complete yet.
  static int port_in(const std::filesystem::path& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    const std::string content = text.str();
    const std::size_t colon = content.find("127.0.0.1:");
    if (colon == std::string::npos || content.find('}') == std::string::npos) return 0;
    return std::stoi(content.substr(colon + 10));
  }

  TemporaryFolder folder_{};
  int port_ = 0;
  pid_t pid_ = 0;
};

}  // namespace dts::test
