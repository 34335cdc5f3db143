// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "fleet/s3/settings.h"
#include "support/temporary_folder.h"

namespace dts::test {

/// tests/support/s3_server.py. It ends with this object or with the test.
class S3Server {
 public:
  /// `certificate`, `key`: files for TLS; empty: without.
  explicit S3Server(const std::string& certificate = "", const std::string& key = "") : scheme_(key.empty() ? "http" : "https") {
    std::ofstream(credentials()) << "tester\na-secret+of/tests\n";
    std::filesystem::permissions(credentials(), std::filesystem::perms(0600));
    pid_ = ::fork();
    if (pid_ == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGKILL);
      ::execl("/usr/bin/python3", "python3", "-B", DTS_S3_SERVER, folder_.path().c_str(), key.empty() ? nullptr : certificate.c_str(),
              key.c_str(), nullptr);
      ::_exit(127);
    }
    for (int tries = 0; tries < 6000; ++tries) {
      if (std::ifstream(folder_.path() + "/port") >> port_) return;
      if (::waitpid(pid_, nullptr, WNOHANG) == pid_) break;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    pid_ = 0;
    throw std::runtime_error("s3_server.py does not start");
  }
  ~S3Server() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  S3Server(const S3Server&) = delete;
  S3Server& operator=(const S3Server&) = delete;

  [[nodiscard]] fleet::s3::Settings settings() const {
    return {.endpoint = scheme_ + "://127.0.0.1:" + std::to_string(port_),
            .bucket = "recordings",
            .region = "eu-test-1",
            .credentials_file = credentials(),
            .ca_file = ""};
  }
  /// "PUT 500": see s3_server.py. Empty: none.
  void set_fault(const std::string& fault) const {
    std::ofstream(folder_.path() + "/fault.new") << fault;
    std::filesystem::rename(folder_.path() + "/fault.new", folder_.path() + "/fault");
  }
  [[nodiscard]] std::filesystem::path object(std::string key) const {
    for (char& letter : key) letter = letter == '/' ? '%' : letter;
    return folder_.path() + "/objects/" + key;
  }
  /// How many uploads in parts are not complete.
  [[nodiscard]] std::ptrdiff_t uploads() const {
    const std::filesystem::directory_iterator folder(folder_.path() + "/uploads");
    return std::distance(begin(folder), end(folder));
  }
  [[nodiscard]] std::string requests() const {
    std::ostringstream text;
    text << std::ifstream(folder_.path() + "/requests").rdbuf();
    return text.str();
  }

 private:
  [[nodiscard]] std::string credentials() const { return folder_.path() + "/credentials"; }

  TemporaryFolder folder_{};
  std::string scheme_;
  int port_ = 0;
  pid_t pid_ = 0;
};

}  // namespace dts::test
