// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "board/damage.h"
#include "board/fake_board.h"

namespace dts::test {

/// Runs a fake board in real time on a descriptor. Returns when `must_stop` is set, or when the descriptor cannot be read.
/// `board` and `damage` are used under `mutex`.
void run_board(FakeBoard& board, int read_fd, int write_fd, Damage& damage, std::mutex& mutex, const std::atomic<bool>& must_stop);

/// A fake board at a pseudo-terminal, which can be unplugged.
class PtyBoard {
 public:
  explicit PtyBoard(FakeBoardSetup setup);
  ~PtyBoard();
  PtyBoard(const PtyBoard&) = delete;
  PtyBoard& operator=(const PtyBoard&) = delete;

  /// The port: a link that names the pseudo-terminal while the board is plugged in.
  [[nodiscard]] std::string path() const { return (folder_ / "port").string(); }
  void plug();
  void unplug();
  /// Presses the reset button.
  void reset();
  void set_damage(const Damage& damage);
  [[nodiscard]] std::uint64_t scans_made();
  [[nodiscard]] std::uint64_t damaged_bytes();

 private:
  std::filesystem::path folder_;
  std::mutex mutex_;
  FakeBoard board_;
  Damage damage_;
  std::atomic<bool> must_stop_{false};
  int fd_ = -1;
  std::thread thread_;
};

}  // namespace dts::test
