// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <functional>
#include <system_error>
#include <thread>
#include <utility>

namespace dts::test {

/// Measures how late the machine is while a test runs: a thread sleeps again and again and remembers by how much it came back too late. The
/// thread needs almost no time on a core, so only the machine makes it late: a program that is blocked does not.
class MachineLateness {
 public:
  using Clock = std::chrono::steady_clock;

  /// Sleeps for `period`. Calls `work` after each sleep: the time that it takes counts as lateness.
  explicit MachineLateness(
      std::chrono::milliseconds period = std::chrono::milliseconds(10), std::function<void()> work = [] {})
      : period_(period), work_(std::move(work)), thread_([this](const std::stop_token& stop) { run(stop); }) {}
  MachineLateness(const MachineLateness&) = delete;
  MachineLateness& operator=(const MachineLateness&) = delete;

  /// Returns the largest lateness so far, that of the present turn included. Thread: any.
  [[nodiscard]] Clock::duration worst() const {
    const Clock::duration present = Clock::now() - begun_.load() - period_;
    return std::max(worst_.load(), present);
  }
  [[nodiscard]] double worst_s() const { return std::chrono::duration<double>(worst()).count(); }

 private:
  void run(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      const Clock::time_point begun = Clock::now();
      begun_ = begun;
      std::this_thread::sleep_for(period_);
      work_();
      worst_ = std::max(worst_.load(), Clock::now() - begun - period_);
    }
  }

  const std::chrono::milliseconds period_;
  const std::function<void()> work_;
  std::atomic<Clock::time_point> begun_{Clock::now()};
  std::atomic<Clock::duration> worst_{Clock::duration::zero()};
  std::jthread thread_;  ///< Last: it uses the others.
};

/// A file without a name on the disk of `folder`, to measure how long the disk takes. Throws if the file cannot be made.
class DiskProbe {
 public:
  explicit DiskProbe(const std::filesystem::path& folder) : file_(::open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0600)) {
    if (file_ < 0) throw std::system_error(errno, std::generic_category(), "no file for measurements in " + folder.string());
  }
  ~DiskProbe() { ::close(file_); }
  DiskProbe(const DiskProbe&) = delete;
  DiskProbe& operator=(const DiskProbe&) = delete;

  /// Writes a byte and waits until it is on the disk. A disk that refuses is not late: it excuses nothing.
  void write() const noexcept {
    const char byte = 0;
    if (::pwrite(file_, &byte, 1, 0) == 1) ::fdatasync(file_);
  }

 private:
  int file_;
};

}  // namespace dts::test
