// SPDX-License-Identifier: Apache-2.0
#include "lsl/lab_recorder.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <memory>
#include <utility>

#include "core/descriptor.h"
#include "core/thread.h"

namespace dts::lsl {
namespace {

using core::ErrorCode;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kConnectionLimit{1000};
constexpr std::chrono::seconds kAnswerLimit{10};  // LabRecorder looks for streams for more than 1 s before it confirms "update" and "start"
constexpr std::chrono::milliseconds kStopCheck{100};
constexpr std::chrono::seconds kRetry{5};
constexpr const char* kHint = "start LabRecorder, and tick RCS in its window (the port is beside it)";

bool wait_until(int descriptor, short events, steady_clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
    pollfd item{.fd = descriptor, .events = events, .revents = 0};
    const int found = ::poll(&item, 1, static_cast<int>(std::max<std::int64_t>(0, left.count())));
    if (found > 0) return true;
    if (found == 0 || errno != EINTR) return false;
  }
}

/// Connects to one address; returns the reason of a failure in `error`.
core::Descriptor connect_to(const addrinfo& address, int& error) {
  core::Descriptor socket(::socket(address.ai_family, address.ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, address.ai_protocol));
  if (socket.get() < 0) {
    error = errno;
    return socket;
  }
  if (::connect(socket.get(), address.ai_addr, address.ai_addrlen) == 0) return socket;
  error = errno;
  if (error != EINPROGRESS) return core::Descriptor(-1);
  error = ETIMEDOUT;
  if (!wait_until(socket.get(), POLLOUT, steady_clock::now() + kConnectionLimit)) return core::Descriptor(-1);
  socklen_t size = sizeof error;
  if (::getsockopt(socket.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0) return core::Descriptor(-1);
  return socket;
}

core::Result<core::Descriptor> connect_to(const std::string& host, std::uint16_t port) {
  const std::string place = host + ":" + std::to_string(port);
  addrinfo wanted{};
  wanted.ai_family = AF_UNSPEC;
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int code = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &wanted, &found); code != 0) {
    return core::fail(ErrorCode::Unreachable, "LabRecorder's address " + place + " is unknown: " + ::gai_strerror(code),
                      "correct [labrecorder] address");
  }
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> addresses(found, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* address = found; address != nullptr; address = address->ai_next) {
    if (core::Descriptor socket = connect_to(*address, error); socket.get() >= 0) return socket;
  }
  return core::fail_errno(error, "LabRecorder does not answer at " + place, kHint);
}

/// Waits for input until the deadline or the stop.
bool wait_for_input(int descriptor, steady_clock::time_point deadline, const std::stop_token& stop) {
  while (!stop.stop_requested() && steady_clock::now() < deadline) {
    if (wait_until(descriptor, POLLIN, std::min(deadline, steady_clock::now() + kStopCheck))) return true;
  }
  return false;
}

/// Sends one command and waits for its "OK": old versions read only one line at a time.
core::Status command(const core::Descriptor& socket, const std::string& line, const std::stop_token& stop) {
  const std::string bytes = line + "\n";
  if (::send(socket.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(bytes.size())) {
    return core::fail_errno(errno, "LabRecorder did not accept the command '" + line + "'", kHint);
  }
  std::string answer;
  std::array<char, 64> received{};
  const auto deadline = steady_clock::now() + kAnswerLimit;
  while (answer.find("OK") == std::string::npos) {
    if (!wait_for_input(socket.get(), deadline, stop)) {
      return core::fail(ErrorCode::Timeout, "LabRecorder did not confirm the command '" + line + "'", "look at LabRecorder's window");
    }
    const ssize_t count = ::recv(socket.get(), received.data(), received.size(), 0);
    if (count <= 0 || answer.size() > received.size()) {
      return core::fail(ErrorCode::Unreachable, "LabRecorder ended the connection after the command '" + line + "'", kHint);
    }
    answer.append(received.data(), static_cast<std::size_t>(count));
  }
  return {};
}

}  // namespace

LabRecorder::LabRecorder(LabRecorderSettings settings, core::Log log) : settings_(std::move(settings)), log_(std::move(log)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

LabRecorder::~LabRecorder() {
  thread_.request_stop();
  thread_.join();
}

void LabRecorder::follow(const std::string& session_id) {
  const std::lock_guard lock(mutex_);
  wanted_ = session_id;
  changed_.notify_all();
}

void LabRecorder::run(const std::stop_token& stop) {
  static_cast<void>(core::configure_this_thread("labrecorder", {}));
  while (!stop.stop_requested()) {
    std::string wanted;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [this] { return !is_settled(); });
      wanted = wanted_;
    }
    if (stop.stop_requested()) break;
    switch_to(wanted, stop);
    std::unique_lock lock(mutex_);
    if (!is_settled()) changed_.wait_for(lock, stop, kRetry, [this, &wanted] { return wanted_ != wanted; });
  }
  if (!asked_.empty()) switch_to({}, {});
}

/// Brings LabRecorder from the recorded session to the wanted one. After a failure, `asked_` and `recorded_` show how far it
/// has come.
void LabRecorder::switch_to(const std::string& wanted, const std::stop_token& stop) {
  if (!asked_.empty()) {
    if (const auto stopped = stop_file(stop); !stopped) return report(stopped.error());
    log_.info("LabRecorder has stopped its file of session " + asked_);
    asked_.clear();
    recorded_.clear();
  }
  if (!wanted.empty()) {
    if (const auto started = start_file(wanted, stop); !started) return report(started.error());
    log_.info("LabRecorder records session " + wanted);
    recorded_ = wanted;
  }
  is_failure_logged_ = false;
}

core::Status LabRecorder::start_file(const std::string& session_id, const std::stop_token& stop) {
  const std::string root = settings_.folder.empty() ? "" : "{root:" + settings_.folder + "} ";
  DTS_TRY_ASSIGN(const core::Descriptor socket, connect_to(settings_.host, settings_.port));
  // "start" selects all streams that LabRecorder has found, so it must look for new ones first.
  DTS_TRY(command(socket, "update", stop));
  DTS_TRY(command(socket, "filename " + root + "{template:dtsd_" + session_id + ".xdf}", stop));
  asked_ = session_id;  // before "start": without its confirmation, LabRecorder may record nevertheless
  return command(socket, "start", stop);
}

core::Status LabRecorder::stop_file(const std::stop_token& stop) {
  DTS_TRY_ASSIGN(const core::Descriptor socket, connect_to(settings_.host, settings_.port));
  return command(socket, "stop", stop);
}

void LabRecorder::report(const core::Error& error) {
  if (!std::exchange(is_failure_logged_, true)) log_.warning(core::to_string(error) + "; dts-lsl retries every 5 s");
}

}  // namespace dts::lsl
