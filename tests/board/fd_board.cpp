// SPDX-License-Identifier: Apache-2.0
#include "board/fd_board.h"

#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <stdexcept>

#include "core/clock.h"

namespace dts::test {

void run_board(FakeBoard& board, int read_fd, int write_fd, Damage& damage, std::mutex& mutex, const std::atomic<bool>& must_stop) {
  core::SystemClock clock;
  std::array<std::uint8_t, 4096> out{};
  std::size_t begin = 0;
  std::size_t end = 0;
  while (!must_stop.load(std::memory_order_acquire)) {  // pairs with PtyBoard::unplug
    std::int64_t next_ns = 0;
    {
      const std::lock_guard lock(mutex);
      board.run_until(clock.now_ns());
      if (begin == end) {
        begin = 0;
        end = damage.apply(out, board.take(std::span(out).first(out.size() / 2)));
      }
      next_ns = board.next_event_ns();
    }
    if (begin < end) {
      const ssize_t written = ::write(write_fd, out.data() + begin, end - begin);
      if (written > 0) begin += static_cast<std::size_t>(written);
      if (written < 0 && errno == EPIPE) return;
      if (begin == end) continue;
    }
    const std::int64_t wait_ms = std::clamp<std::int64_t>((next_ns - clock.now_ns() + 999'999) / 1'000'000, 0, 10);
    pollfd event{read_fd, POLLIN, 0};
    if (::poll(&event, 1, static_cast<int>(begin < end ? 1 : wait_ms)) <= 0) continue;
    std::array<std::uint8_t, 512> in{};
    const ssize_t count = ::read(read_fd, in.data(), in.size());
    if (count == 0) return;
    if (count < 0 && errno == EIO) {  // nobody has the port open
      clock.sleep_until_ns(clock.now_ns() + 1'000'000);
      continue;
    }
    if (count < 0) continue;
    const std::lock_guard lock(mutex);
    board.receive(std::span(in).first(static_cast<std::size_t>(count)), clock.now_ns());
  }
}

PtyBoard::PtyBoard(FakeBoardSetup setup) : board_(std::move(setup), core::SystemClock().now_ns()) {
  std::string name = (std::filesystem::temp_directory_path() / "dts_board_XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("mkdtemp failed");
  folder_ = name;
  plug();
}

PtyBoard::~PtyBoard() {
  unplug();
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void PtyBoard::plug() {
  fd_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0 || ::grantpt(fd_) != 0 || ::unlockpt(fd_) != 0) throw std::runtime_error("posix_openpt failed");
  termios raw{};
  ::tcgetattr(fd_, &raw);
  ::cfmakeraw(&raw);
  ::tcsetattr(fd_, TCSANOW, &raw);
  std::filesystem::create_symlink(::ptsname(fd_), path());
  board_.reset(core::SystemClock().now_ns());
  must_stop_.store(false, std::memory_order_release);  // pairs with run_board
  thread_ = std::thread([this] { run_board(board_, fd_, fd_, damage_, mutex_, must_stop_); });
}

void PtyBoard::unplug() {
  if (fd_ < 0) return;
  must_stop_.store(true, std::memory_order_release);  // pairs with run_board
  thread_.join();
  std::filesystem::remove(path());
  ::close(fd_);
  fd_ = -1;
}

void PtyBoard::reset() {
  const std::lock_guard lock(mutex_);
  board_.reset(core::SystemClock().now_ns());
}

void PtyBoard::set_damage(const Damage& damage) {
  const std::lock_guard lock(mutex_);
  damage_ = damage;
}

std::uint64_t PtyBoard::scans_made() {
  const std::lock_guard lock(mutex_);
  return board_.scans_made();
}

std::uint64_t PtyBoard::damaged_bytes() {
  const std::lock_guard lock(mutex_);
  return damage_.count;
}

}  // namespace dts::test
