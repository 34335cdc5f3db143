// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "fault/child_process.h"

namespace dts::fault {

/// What a disk was told: to write bytes, or to make everything before durable.
struct DiskEvent {
  bool is_flush = false;
  std::uint64_t offset = 0;
  std::vector<char> bytes{};
};

/// Reads the first `length` bytes of a disk's log. An event that is not whole is left out: the disk had not confirmed it.
/// Throws std::runtime_error if the log cannot be read.
[[nodiscard]] std::vector<DiskEvent> read_log(const std::string& log, std::uint64_t length);

/// Writes into `image` what a disk with a volatile cache may have when its power fails after these events: every write before the last
/// flush; of each later one all, nothing, or some sectors of 512 bytes, by chance. Throws std::runtime_error if it cannot be written.
void write_survivors(std::span<const DiskEvent> events, std::mt19937& random, const std::string& image);

/// A disk of this machine's kernel whose writes and flushes are logged: a file system on a loop device, above a file that a process of
/// this class serves (FUSE). Power can fail at any moment of the log, as often as wanted. Needs root, /dev/fuse, libfuse3 and mkfs.
/// Thread: `written` any, the others one at a time.
class LoggedDisk {
 public:
  /// Makes a disk with a file system ("ext4" or "xfs") and mounts it at `folder`. Forks: no other thread may run yet.
  /// Throws std::runtime_error.
  LoggedDisk(std::string_view file_system, std::string folder);
  ~LoggedDisk();
  LoggedDisk(const LoggedDisk&) = delete;
  LoggedDisk& operator=(const LoggedDisk&) = delete;

  /// Length of the log now: the moment of a power failure.
  [[nodiscard]] std::uint64_t written() const;
  /// Mounts at the folder, in the place of what is there, what the disk may have after a power failure at that moment: the kernel repairs
  /// the file system from its journal. Throws std::runtime_error if it cannot.
  void restore(std::uint64_t moment, std::mt19937& random);

 private:
  void serve() const;
  void mount_new(std::string_view file_system);
  void close() const noexcept;

  std::string folder_;
  TemporaryFolder scratch_{"/dev/shm"};  // in memory: what is written when is the question, not how fast
  std::uint64_t size_;
  pid_t server_ = -1;
  bool is_mounted_ = false;
};

}  // namespace dts::fault
