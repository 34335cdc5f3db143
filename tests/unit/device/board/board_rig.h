// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "board/fake_board_device.h"
#include "unit/device/sim_rig.h"

namespace dts::device::board::test {

using device::test::kNoDeadline;
using device::test::rate_of;
using dts::test::FakeBoard;
using dts::test::FakeBoardSetup;
using dts::test::FakeLink;
using dts::test::OwnedFakeLink;

inline constexpr std::int64_t kMs = core::kNanosecondsPerMillisecond;
inline constexpr std::int64_t kSecond = core::kNanosecondsPerSecond;

/// Which scan of the fake board a block's scan is; nothing if the values do not belong together: then they are wrong.
struct Origin {
  std::uint8_t run = 0;
  std::uint32_t counter = 0;  ///< 30 bits.
};
inline std::optional<Origin> origin_of(const core::Block& block, std::size_t scan) {
  const auto code = [&](std::size_t channel) {
    const double value = block.column(channel)[scan];
    const auto found = static_cast<std::int16_t>(std::lround(value / (5.0 / 32767.0)));
    return dts::test::fake_value(found) == value ? found : std::int16_t{-1};
  };
  const std::int16_t low = code(0);
  const std::int16_t run = code(1);
  const std::int16_t high = code(3);
  if (low < 0 || run < 1 || run > 256 || high < 0) return std::nullopt;
  const Origin origin{static_cast<std::uint8_t>(run - 1), static_cast<std::uint32_t>(low) | static_cast<std::uint32_t>(high) << 15U};
  for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
    if (code(channel) != dts::test::fake_code(origin.run, origin.counter, channel)) return std::nullopt;
  }
  return origin;
}

/// Follows what a device delivers of a fake board with at least four channels: each scan must be one that the board made, and no loss may
/// be hidden.
class Witness {
 public:
  explicit Witness(std::size_t channels) : block(channels, 64) {}

  ReadResult read(Device& device, std::int64_t deadline_ns) {
    const ReadResult result = device.read(block, deadline_ns);
    EXPECT_EQ(result.outcome == ReadOutcome::Scans, block.count() > 0);
    if (result.outcome == ReadOutcome::Scans) {
      note_block();
    } else if (result.outcome != ReadOutcome::Timeout) {
      note_gap(result);
    }
    return result;
  }
  /// A new start of the device: nothing is expected of the next scan.
  void restart() {
    last_.reset();
    next_index_ = 0;
    gap_.reset();
  }

  core::Block block;
  std::uint64_t scans = 0;
  std::uint64_t gaps = 0;
  std::uint64_t exact_missing = 0;
  std::uint64_t hidden_losses = 0;  ///< Scans that do not follow the scan before, without a gap.
  std::uint64_t wrong_counts = 0;   ///< Exact gaps whose count is wrong.
  std::uint64_t wrong_values = 0;
  std::optional<Origin> first;

 private:
  void note_gap(const ReadResult& result) {
    ++gaps;
    next_index_ = 0;
    if (gap_) {
      gap_->missing_scans += result.gap.missing_scans;
      gap_->is_exact = gap_->is_exact && result.gap.is_exact && result.outcome == ReadOutcome::Gap;
    } else {
      gap_ = result.gap;
      gap_->is_exact = result.gap.is_exact && result.outcome == ReadOutcome::Gap;
    }
  }
  void note_block() {
    EXPECT_EQ(block.first_scan.value, next_index_);
    next_index_ += block.count();
    for (std::size_t scan = 0; scan < block.count(); ++scan) {
      const auto origin = origin_of(block, scan);
      if (!origin) {
        ++wrong_values;
        continue;
      }
      ++scans;
      if (!first) first = origin;
      check(*origin);
      last_ = origin;
    }
  }
  void check(const Origin& origin) {
    const auto gap = std::exchange(gap_, std::nullopt);
    if (!last_) {
      if (gap && gap->is_exact && gap->missing_scans != origin.counter) ++wrong_counts;
      return;
    }
    const std::uint32_t step = (origin.counter - last_->counter) & 0x3FFFFFFFU;
    const bool follows = origin.run == last_->run && step == 1;
    if (!gap) {
      if (!follows) ++hidden_losses;
      return;
    }
    if (!gap->is_exact) return;
    exact_missing += gap->missing_scans;
    if (origin.run != last_->run || step != gap->missing_scans + 1) ++wrong_counts;
  }

  std::uint64_t next_index_ = 0;
  std::optional<Origin> last_;
  std::optional<core::Gap> gap_;
};

/// A device, its fake board and a virtual clock.
struct BoardRig {
  explicit BoardRig(FakeBoardSetup setup = {}, const std::string& options = "channels=4", const std::string& scheme = "serial") {
    const auto uri = DeviceUri::parse(scheme + ":fake?" + options);
    auto read = read_board_options(uri.value(), scheme == "serial");
    EXPECT_TRUE(read.has_value()) << (read ? "" : core::to_string(read.error()));
    auto owned = std::make_unique<OwnedFakeLink>(std::move(setup), clock);
    link = &owned->link();
    board = &owned->board();
    device = std::make_unique<BoardDevice>(std::move(*read), std::move(owned), clock);
    witness.emplace(device->describe().channels.size());
  }

  void open() {
    const auto opened = device->open();
    ASSERT_TRUE(opened.has_value()) << core::to_string(opened.error());
  }
  void start(double rate_hz = 100.0, std::size_t block_scans = 64) {
    if (device->state() == DeviceState::Closed) open();
    const auto started = device->start({rate_of(rate_hz), block_scans});
    ASSERT_TRUE(started.has_value()) << core::to_string(started.error());
    witness->restart();
  }
  core::Error open_error() {
    const auto opened = device->open();
    EXPECT_FALSE(opened.has_value());
    EXPECT_EQ(device->state(), DeviceState::Closed);
    return opened ? core::Error{} : opened.error();
  }
  ReadResult read(std::int64_t patience_ns = kSecond) { return witness->read(*device, clock.now_ns() + patience_ns); }
  /// Reads until something else than scans or nothing comes, at most `seconds`.
  ReadResult read_until_trouble(double seconds) {
    const std::int64_t until_ns = clock.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
    ReadResult result;
    do {
      result = read(100 * kMs);
    } while ((result.outcome == ReadOutcome::Scans || result.outcome == ReadOutcome::Timeout) && clock.now_ns() < until_ns);
    return result;
  }
  [[nodiscard]] const DeviceCheck* check(const std::string& name_part) {
    report = device->report();
    for (const DeviceCheck& one : report.checks) {
      if (one.name.find(name_part) != std::string::npos) return &one;
    }
    return nullptr;
  }
  void expect_nothing_hidden() const {
    EXPECT_EQ(witness->wrong_values, 0U);
    EXPECT_EQ(witness->hidden_losses, 0U);
    EXPECT_EQ(witness->wrong_counts, 0U);
  }

  core::VirtualClock clock{1000 * kSecond};
  FakeLink* link = nullptr;
  FakeBoard* board = nullptr;
  std::unique_ptr<BoardDevice> device;
  std::optional<Witness> witness;
  DeviceReport report;
};

}  // namespace dts::device::board::test
