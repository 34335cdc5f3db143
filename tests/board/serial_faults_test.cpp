// SPDX-License-Identifier: Apache-2.0
// A bad serial line in real time, over a pseudo-terminal: bit flips, dropped and doubled bytes, 10 resets and 10 replugs. No wrong value
// may be delivered, and no loss may be hidden. DTS_SERIAL_SCANS sets the number of scans; scripts/fault serial runs the long form.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "board/fd_board.h"
#include "device/registry.h"
#include "unit/device/board/board_rig.h"

namespace dts::device::board::test {
namespace {

constexpr int kResets = 10;
constexpr int kReplugs = 10;
constexpr double kRateHz = 10'000.0;

/// Opens and starts the device, for at most 30 s.
bool bring_up(Device& device, core::Clock& clock) {
  for (const std::int64_t until_ns = clock.now_ns() + 30 * kSecond; clock.now_ns() < until_ns;) {
    if (device.state() == DeviceState::Gone) (void)device.close();
    if (device.open() && device.start({rate_of(kRateHz), 64})) return true;
    clock.sleep_until_ns(clock.now_ns() + 10 * kMs);
  }
  return false;
}

TEST(SerialFaults, BadLineResetsAndReplugs_HideNothing) {
  RecordProperty("requirement", "ACQ-14");
  const char* const wanted = std::getenv("DTS_SERIAL_SCANS");
  const std::uint64_t scans = wanted != nullptr ? std::stoull(wanted) : 40'000;
  core::SystemClock clock;
  const physics::RigModel plate = device::test::floor_rig();
  dts::test::PtyBoard board({.scans_per_frame = 10});
  board.set_damage({.flip = 1e-5, .drop = 1e-5, .doubled = 1e-5});
  const auto created = create_device("serial:" + board.path() + "?channels=4", {clock, plate});
  ASSERT_TRUE(created.has_value());
  Device& device = **created;
  ASSERT_TRUE(bring_up(device, clock));
  Witness witness(4);
  std::uint64_t restarts = 0;
  for (int round = 0; round < kResets + kReplugs; ++round) {
    const std::uint64_t until = scans * static_cast<std::uint64_t>(round + 1) / (kResets + kReplugs);
    std::int64_t newest_ns = clock.now_ns();
    while (witness.scans < until) {
      ASSERT_LT(clock.now_ns() - newest_ns, 60 * kSecond) << "no scans";
      const ReadResult result = witness.read(device, clock.now_ns() + 100 * kMs);
      if (result.outcome == ReadOutcome::Scans) newest_ns = clock.now_ns();
      if (result.outcome != ReadOutcome::Broken && result.outcome != ReadOutcome::Gone) continue;
      ++restarts;
      (void)device.stop();
      ASSERT_TRUE(bring_up(device, clock));
    }
    if (round % 2 == 0) {
      board.reset();
    } else {
      board.unplug();
      board.plug();
    }
  }
  std::printf(
      "%llu scans delivered of %llu, %llu damaged bytes, %llu gaps, %llu scans counted as lost, %llu restarts; wrong values: %llu, "
      "hidden losses: %llu, wrong counts: %llu\n",
      static_cast<unsigned long long>(witness.scans), static_cast<unsigned long long>(board.scans_made()),
      static_cast<unsigned long long>(board.damaged_bytes()), static_cast<unsigned long long>(witness.gaps),
      static_cast<unsigned long long>(witness.exact_missing), static_cast<unsigned long long>(restarts),
      static_cast<unsigned long long>(witness.wrong_values), static_cast<unsigned long long>(witness.hidden_losses),
      static_cast<unsigned long long>(witness.wrong_counts));
  EXPECT_EQ(witness.wrong_values, 0U);
  EXPECT_EQ(witness.hidden_losses, 0U);
  EXPECT_EQ(witness.wrong_counts, 0U);
  EXPECT_GE(witness.gaps, static_cast<std::uint64_t>(kResets));
  EXPECT_GT(board.damaged_bytes(), 0U);
}

}  // namespace
}  // namespace dts::device::board::test
