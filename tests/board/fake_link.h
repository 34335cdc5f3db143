// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "board/damage.h"
#include "board/fake_board.h"
#include "core/clock.h"
#include "device/bytes/byte_link.h"

namespace dts::test {

/// A link to a fake board in memory. Waiting is sleeping on the clock, so a virtual clock runs as fast as the computer allows.
class FakeLink final : public device::bytes::ByteLink {
 public:
  FakeLink(FakeBoard& board, core::Clock& clock) : board_(board), clock_(clock) {}

  // Faults
  std::optional<double> unplug_at_s;  ///< Since the start of the run, while the device waits for scans; for 1 s.
  bool is_plugged = true;
  Damage damage;
  bool resets_on_open = true;
  bool takes_bytes = true;
  std::int64_t reads_late_ns = 0;  ///< A waiting read ends this much later, with all that has come until then.
  std::string adapter_serial;

  [[nodiscard]] core::Status open() override {
    if (back_at_ns_ <= clock_.now_ns() && back_at_ns_ != 0) is_plugged = true;
    if (!is_plugged) return core::fail(core::ErrorCode::NotFound, "cannot open the fake board: it is not plugged in");
    if (resets_on_open) board_.reset(clock_.now_ns());
    board_.run_until(clock_.now_ns());
    if (!resets_on_open) board_.drop_output();
    opened_ns_ = clock_.now_ns();
    has_unplugged_ = false;
    return {};
  }
  void close() noexcept override {}
  [[nodiscard]] device::bytes::BytesRead read(std::span<std::uint8_t> buffer, std::int64_t deadline_ns) noexcept override {
    using device::bytes::ReadEnd;
    while (true) {
      const std::int64_t now_ns = clock_.now_ns();
      if (is_interrupted_.exchange(false)) return {ReadEnd::Interrupted, 0, 0};
      if (is_time_to_unplug(now_ns, deadline_ns)) {
        is_plugged = false;
        has_unplugged_ = true;
        back_at_ns_ = now_ns + core::kNanosecondsPerSecond;
      }
      if (!is_plugged) return {ReadEnd::Lost, 0, 0};
      board_.run_until(now_ns);
      const std::size_t count = damage.apply(buffer, board_.take(buffer.first(buffer.size() / 2)));
      if (count > 0) return {ReadEnd::Bytes, count, clock_.raw_ns()};
      if (now_ns >= deadline_ns) return {ReadEnd::Timeout, 0, 0};
      clock_.sleep_until_ns(std::min({deadline_ns, std::max(board_.next_event_ns(), now_ns + 1), now_ns + kSliceNs}) + reads_late_ns);
    }
  }
  [[nodiscard]] core::Status write(std::span<const std::uint8_t> bytes) override {
    if (!is_plugged) return core::fail(core::ErrorCode::DeviceGone, "the fake board is gone");
    if (takes_bytes) board_.receive(bytes, clock_.now_ns());
    return {};
  }
  void interrupt() noexcept override { is_interrupted_ = true; }
  [[nodiscard]] bool has_arrived() noexcept override { return false; }
  [[nodiscard]] Facts facts() const override { return {.nodes = {"/dev/fake"}, .serial = adapter_serial}; }
  [[nodiscard]] std::string why_lost() const override { return is_plugged ? "" : "it was unplugged"; }
  [[nodiscard]] bool restarts_the_board() const noexcept override { return resets_on_open; }

 private:
  static constexpr std::int64_t kSliceNs = 10 * core::kNanosecondsPerMillisecond;

  [[nodiscard]] bool is_time_to_unplug(std::int64_t now_ns, std::int64_t deadline_ns) const noexcept {
    if (!unplug_at_s || !is_plugged || has_unplugged_ || deadline_ns <= now_ns || !board_.is_streaming()) return false;
    return static_cast<double>(now_ns - std::max(opened_ns_, board_.run_start_ns())) * 1e-9 >= *unplug_at_s;
  }
  FakeBoard& board_;
  core::Clock& clock_;
  std::atomic<bool> is_interrupted_{false};
  bool has_unplugged_ = false;
  std::int64_t opened_ns_ = 0;
  std::int64_t back_at_ns_ = 0;
};

}  // namespace dts::test
