// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grp.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "support/temporary_folder.h"

namespace dts::test {

/// A real PostgreSQL that listens to a socket in a folder of its own, and ends with this object or with the test. Root starts it as user
/// postgres, because its programs refuse root. It does not synchronise files: the tests do not cut the power.
class PostgresServer {
 public:
  /// Returns the folder of PostgreSQL's programs, or nothing if it is not installed: then the test is skipped.
  [[nodiscard]] static std::optional<std::string> programs() {
    if (::geteuid() == 0 && ::getpwnam("postgres") == nullptr) return std::nullopt;
    std::vector<std::string> found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/usr/lib/postgresql", error)) {
      const std::string folder = entry.path().string() + "/bin";
      if (::access((folder + "/postgres").c_str(), X_OK) == 0) found.push_back(folder);
    }
    if (found.empty()) return std::nullopt;
    return *std::ranges::max_element(found);
  }

  /// Throws if it does not start.
  PostgresServer() {
    if (const passwd* const user = user_of_server()) {
      if (::chown(folder_.path().c_str(), user->pw_uid, user->pw_gid) != 0) throw std::runtime_error("cannot chown");
    }
    const pid_t made = spawn({"initdb", "-D", data(), "-A", "trust", "-U", "dts_hub", "-E", "UTF8", "--locale=C", "--no-sync"});
    int status = 0;
    ::waitpid(made, &status, 0);
    if (status != 0) throw std::runtime_error("initdb failed: " + log_text());
    start();
  }
  ~PostgresServer() { kill(); }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  /// Ends it and all connections at once, as after a crash.
  void kill() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGQUIT);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
  }
  /// Starts it again with the same data.
  void start() {
    kill();
    std::filesystem::remove(folder_.path() + "/postgres.log");  // it says that an earlier one is ready
    pid_ = spawn({"postgres", "-D", data(), "-k", folder_.path(), "-c", "listen_addresses=", "-c", "fsync=off", "-c", "shared_buffers=16MB",
                  "-c", "max_connections=40"});
    for (int tries = 0; tries < 3000; ++tries) {
      if (log_text().find("ready to accept connections") != std::string::npos) return;
      if (::waitpid(pid_, nullptr, WNOHANG) == pid_) {
        pid_ = 0;
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    throw std::runtime_error("PostgreSQL does not start: " + log_text());
  }

  /// Returns the connection to a database, as libpq understands it. "postgres" exists.
  [[nodiscard]] std::string connection(const std::string& database = "postgres", const std::string& user = "dts_hub") const {
    return "host=" + folder_.path() + " dbname=" + database + " user=" + user;
  }
  [[nodiscard]] const std::string& folder() const noexcept { return folder_.path(); }

 private:
  static const passwd* user_of_server() { return ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr; }
  [[nodiscard]] std::string data() const { return folder_.path() + "/data"; }
  [[nodiscard]] std::string log_text() const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() + "/postgres.log").rdbuf();
    return text.str();
  }

  pid_t spawn(const std::vector<std::string>& words) {
    const std::string program = *programs() + "/" + words.front();
    const std::string log = folder_.path() + "/postgres.log";
    const passwd* const user = user_of_server();
    const pid_t pid = ::fork();
    if (pid < 0) throw std::runtime_error("cannot fork");
    if (pid > 0) return pid;
    if (user != nullptr && (::setgroups(0, nullptr) != 0 || ::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0)) ::_exit(126);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);  // after the change of the user, which clears it
    if (std::freopen(log.c_str(), "w", stdout) == nullptr || ::dup2(STDOUT_FILENO, STDERR_FILENO) < 0) ::_exit(126);
    if (::chdir(folder_.path().c_str()) != 0) ::_exit(126);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execv(program.c_str(), arguments.data());
    ::_exit(127);
  }

  TemporaryFolder folder_{};
  pid_t pid_ = 0;
};

}  // namespace dts::test
