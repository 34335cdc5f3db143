// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/error_lines.h"

#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "core/thread.h"
#include "core/utf8.h"

namespace dts::device::bytes {
namespace {

constexpr double kLinesPerSecond = 5.0;
constexpr std::size_t kLongestLine = 200;
constexpr std::size_t kKeptLines = 3;
constexpr std::size_t kReadBytes = 16 * 1024;

/// Returns where the last lines begin that are kept; 0 if all are.
std::size_t newest_lines(std::string_view bytes) noexcept {
  std::size_t start = bytes.size();
  for (std::size_t found = 0; found <= kKeptLines;) {
    const std::size_t newline = start == 0 ? std::string_view::npos : bytes.rfind('\n', start - 1);
    if (newline == std::string_view::npos) return 0;
    if (newline + 1 < start) ++found;  // an empty line is none
    start = newline;
  }
  return start;
}

}  // namespace

ErrorLines::ErrorLines(core::Descriptor errors, std::string name, core::Log log)
    : errors_(std::move(errors)), name_(std::move(name)), log_(std::move(log)), allowance_(kLinesPerSecond), thread_([this] {
        read_all();
      }) {}

ErrorLines::~ErrorLines() {
  stop_.ring();
  thread_.join();
}

std::string ErrorLines::last_lines(std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  ended_.wait_for(lock, limit, [this] { return has_ended_; });
  std::string joined;
  for (const std::string& line : lines_) joined += (joined.empty() ? "" : " | ") + line;
  return joined;
}

void ErrorLines::read_all() {
  const sched_param ordinary{};  // a thread inherits the real-time policy of the rig's: a flood would be real-time load
  ::pthread_setschedparam(::pthread_self(), SCHED_OTHER, &ordinary);
  static_cast<void>(core::configure_this_thread("program-errors", {.fifo_priority = 0, .cpus = {}}));
  std::array<char, kReadBytes> bytes{};
  while (true) {
    std::array<pollfd, 2> waiters{
        {{.fd = errors_.get(), .events = POLLIN, .revents = 0}, {.fd = stop_.fd(), .events = POLLIN, .revents = 0}}};
    if (::poll(waiters.data(), waiters.size(), -1) < 0 && errno != EINTR) break;
    if (waiters[1].revents != 0) break;
    if (waiters[0].revents == 0) continue;
    const ssize_t count = ::read(errors_.get(), bytes.data(), bytes.size());
    if (count > 0) add({bytes.data(), static_cast<std::size_t>(count)});
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) break;
  }
  if (!line_.empty()) end_line();
  if (unlogged_ > 0) log_.warning(name_ + ": " + std::to_string(unlogged_) + " more lines of its stderr were not logged");
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  ended_.notify_all();
}

void ErrorLines::add(std::string_view bytes) {
  if (!allowance_.has_one(core::TokenBucket::Time::clock::now())) {  // only counts the lines that would be neither logged nor kept
    const std::size_t kept = newest_lines(bytes);
    bool has_text = !line_.empty();
    for (const char byte : bytes.substr(0, kept == 0 ? 0 : kept + 1)) {  // with the line end at `kept`
      if (byte == '\n' && has_text) ++unlogged_;
      has_text = byte != '\n';
    }
    bytes.remove_prefix(kept);
    if (kept > 0) line_.clear();
  }
  while (!bytes.empty()) {
    const std::size_t end = bytes.find('\n');
    const std::string_view part = bytes.substr(0, end);
    line_ += part.substr(0, kLongestLine - std::min(kLongestLine, line_.size()));
    if (end == std::string_view::npos) return;
    if (!line_.empty()) end_line();
    bytes.remove_prefix(end + 1);
  }
}

void ErrorLines::end_line() {
  std::string line = core::printable(line_);
  line_.clear();
  const auto now = core::TokenBucket::Time::clock::now();
  if (allowance_.take(now)) {
    std::string text = name_ + ": " + line;
    if (unlogged_ > 0) text += " (before it, " + std::to_string(std::exchange(unlogged_, 0)) + " lines of its stderr were not logged)";
    log_.info(text);
  } else {
    ++unlogged_;
  }
  const std::lock_guard lock(mutex_);
  lines_.push_back(std::move(line));
  if (lines_.size() > kKeptLines) lines_.pop_front();
}

}  // namespace dts::device::bytes
