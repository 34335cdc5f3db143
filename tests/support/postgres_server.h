// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <grp.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
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

/// A real PostgreSQL in a folder of its own, with a Unix socket and no network address. It ends with this object or with the test.
/// PostgreSQL does not run as root: there it runs as user postgres. It does not wait for the disk: no test cuts the power.
class PostgresServer {
 public:
  /// Returns the folder of the programs, or nothing if they are not installed: then the test is skipped.
  [[nodiscard]] static std::optional<std::string> programs() {
    std::error_code ignored;
    for (const auto& version : std::filesystem::directory_iterator("/usr/lib/postgresql", ignored)) {
      if (::access((version.path() / "bin/initdb").c_str(), X_OK) == 0) return (version.path() / "bin").string();
    }
    return std::nullopt;
  }

  /// Creates the cluster and starts it. Throws if this fails.
  PostgresServer() {
    std::filesystem::permissions(folder_.path(), std::filesystem::perms(0755));
    std::filesystem::create_directory(folder_.path() + "/socket");
    std::filesystem::create_directory(folder_.path() + "/data");
    if (::getuid() == 0) {
      const passwd* const user = ::getpwnam("postgres");
      if (user == nullptr) throw std::runtime_error("there is no user postgres");
      user_ = user->pw_uid;
      group_ = user->pw_gid;
      for (const char* const name : {"/socket", "/data"}) {
        if (::chown((folder_.path() + name).c_str(), user_, group_) != 0) throw std::runtime_error("cannot change the owner");
      }
    }
    const pid_t made =
        spawn({*programs() + "/initdb", "-D", data(), "-U", "dts_hub", "-A", "trust", "-E", "UTF8", "--locale=C", "--no-sync"});
    int status = 0;
    if (::waitpid(made, &status, 0) != made || status != 0) throw std::runtime_error("initdb failed: " + log_text());
    start();
  }
  ~PostgresServer() { stop(SIGQUIT); }
  PostgresServer(const PostgresServer&) = delete;
  PostgresServer& operator=(const PostgresServer&) = delete;

  void start() {
    pid_ = spawn({*programs() + "/postgres", "-D", data(), "-k", folder_.path() + "/socket", "-c", "listen_addresses=", "-c", "fsync=off",
                  "-c", "shared_buffers=16MB", "-c", "autovacuum=off"});
    for (int tries = 0; tries < 6000; ++tries) {
      if (std::filesystem::exists(folder_.path() + "/socket/.s.PGSQL.5432") &&
          log_text().find("ready to accept connections") != std::string::npos) {
        return;
      }
      if (::waitpid(pid_, nullptr, WNOHANG) == pid_) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = 0;
    throw std::runtime_error("PostgreSQL does not start: " + log_text());
  }
  /// SIGINT ends it with all connections, SIGQUIT without writing anything more.
  void stop(int signal) {
    if (pid_ <= 0) return;
    ::kill(pid_, signal);
    ::waitpid(pid_, nullptr, 0);
    pid_ = 0;
    std::error_code ignored;
    std::filesystem::remove(folder_.path() + "/log", ignored);
  }

  /// For libpq.
  [[nodiscard]] std::string connection(const std::string& database = "postgres", const std::string& user = "dts_hub") const {
    return "host=" + folder_.path() + "/socket dbname=" + database + " user=" + user;
  }

 private:
  [[nodiscard]] std::string data() const { return folder_.path() + "/data"; }
  [[nodiscard]] std::string log_text() const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() + "/log").rdbuf();
    return text.str();
  }
  /// The process ends with this one.
  [[nodiscard]] pid_t spawn(std::vector<std::string> words) const {
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("cannot fork");
    if (child > 0) return child;
    const std::string log = folder_.path() + "/log";
    if (std::freopen(log.c_str(), "a", stderr) == nullptr || std::freopen("/dev/null", "w", stdout) == nullptr) ::_exit(126);
    if (user_ != 0 && (::setgroups(0, nullptr) != 0 || ::setgid(group_) != 0 || ::setuid(user_) != 0)) ::_exit(126);
    ::prctl(PR_SET_PDEATHSIG, SIGQUIT);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    ::execv(arguments.front(), arguments.data());
    ::_exit(127);
  }

  TemporaryFolder folder_{};
  uid_t user_ = 0;
  gid_t group_ = 0;
  pid_t pid_ = 0;
};

}  // namespace dts::test
