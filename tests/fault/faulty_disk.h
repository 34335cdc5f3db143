// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace dts::fault {

/// What can fail. Each stands for the functions of libc that do it: Write for write, pwrite and pwrite64, and so on.
enum class Operation : std::uint8_t { Write, Fsync, Fdatasync, Rename, Open, Truncate, Unlink };
inline constexpr std::array kOperations{Operation::Write, Operation::Fsync,    Operation::Fdatasync, Operation::Rename,
                                        Operation::Open,  Operation::Truncate, Operation::Unlink};
[[nodiscard]] std::string_view name(Operation operation) noexcept;

struct Fault {
  Operation operation = Operation::Write;
  std::uint64_t nth = 1;    ///< The first call that fails, counted from 1.
  int error = 0;            ///< errno
  bool is_lasting = false;  ///< From then on every call fails; a write is torn first: half of it reaches the file.
  bool is_kill = false;     ///< SIGKILL for this process in place of the error.
};
/// "write 17 ENOSPC for ever"
[[nodiscard]] std::string to_text(const Fault& fault);

/// Stands between this program, with the libraries in it, and the disk: the functions are defined in faulty_disk.cpp and so win over those
/// of libc (SQLite's calls included). Only calls on files below `root` count and fail. One at a time in a process.
/// Thread: construction, `arm` and `disarm` on one; the calls on any.
class FaultyDisk {
 public:
  explicit FaultyDisk(std::string root);
  ~FaultyDisk();
  FaultyDisk(const FaultyDisk&) = delete;
  FaultyDisk& operator=(const FaultyDisk&) = delete;

  /// Starts counting anew.
  void arm(const Fault& fault) noexcept;
  void disarm() noexcept { is_armed_.store(false, std::memory_order_release); }  // pairs with error_for()
  [[nodiscard]] std::uint64_t calls(Operation operation) const noexcept {
    return calls_[static_cast<std::size_t>(operation)].load(std::memory_order_relaxed);
  }
  [[nodiscard]] bool has_struck() const noexcept { return has_struck_.load(std::memory_order_relaxed); }

  /// Called before a file or folder is synchronised; what it returns is called when that has succeeded. Set it before anything runs.
  using Done = std::function<void()>;
  std::function<Done(int descriptor, const std::string& path)> on_synchronise;

  /// For the functions in faulty_disk.cpp.
  struct Verdict {
    int error = 0;  ///< 0: goes on.
    bool is_torn = false;
  };
  [[nodiscard]] Verdict error_for(Operation operation, std::string_view path) noexcept;
  [[nodiscard]] Verdict error_for(Operation operation, int descriptor) noexcept;
  [[nodiscard]] bool is_mine(std::string_view path) const noexcept { return path.starts_with(root_); }

 private:
  std::string root_;
  Fault fault_;
  std::atomic<bool> is_armed_{false};
  std::atomic<bool> has_struck_{false};
  std::array<std::atomic<std::uint64_t>, kOperations.size()> calls_{};
};

}  // namespace dts::fault
