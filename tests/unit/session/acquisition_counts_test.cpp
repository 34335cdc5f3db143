// SPDX-License-Identifier: Apache-2.0
// What the acquire thread counts: losses by cause, and how full its ring was.
#include <gtest/gtest.h>

#include "scripted_device.h"
#include "session/acquisition.h"

namespace dts::session {
namespace {

using device::ReadOutcome;

constexpr std::size_t kCountedScans = 8;

/// The report after a script was played into a ring that nobody reads.
AcquisitionReport played(std::deque<ScriptedDevice::Step> script, core::VirtualClock& clock, std::size_t ring_blocks = 64) {
  ScriptedDevice device(std::move(script));
  core::SpscRing<core::Acquired> ring(ring_blocks, core::Acquired{.block = core::Block(1, kCountedScans)});
  core::Doorbell bell;
  Acquisition acquisition(device, clock, ring, bell, core::Rate::create(100, 1).value(), kCountedScans);
  device.on_end = [&] { acquisition.request_stop(); };
  acquisition.run();
  return acquisition.report();
}

TEST(AcquisitionCounts, LossesStandUnderTheirCause_AndAddUp) {
  const core::Gap overrun{.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true};
  const core::Gap longer{.reason = core::GapReason::Overrun, .missing_scans = 7, .is_exact = true};
  core::VirtualClock clock;

  const AcquisitionReport report = played({{.scans = 3},
                                           {.outcome = ReadOutcome::Gap, .gap = overrun},
                                           {.scans = 2},
                                           {.outcome = ReadOutcome::Gap, .gap = longer},
                                           {.scans = 2},
                                           {.scans = 2, .skip_index = 3}},
                                          clock);

  EXPECT_EQ(report.losses.of(core::GapReason::Overrun), (core::LossCount{.gaps = 2, .scans = 12}));
  EXPECT_EQ(report.losses.of(core::GapReason::Integrity), (core::LossCount{.gaps = 1, .scans = 3}));
  EXPECT_EQ(report.losses.total(), (core::LossCount{.gaps = 3, .scans = 15}));
}

TEST(AcquisitionCounts, RingThatNobodyReads_WasFull) {
  core::VirtualClock clock;

  const AcquisitionReport full = played(std::deque<ScriptedDevice::Step>(12, {.scans = 2}), clock, 8);
  const AcquisitionReport half = played(std::deque<ScriptedDevice::Step>(4, {.scans = 2}), clock, 8);

  EXPECT_EQ(full.ring_blocks.at(clock.now_ns()), 8U);
  EXPECT_EQ(half.ring_blocks.at(clock.now_ns()), 4U);
}

}  // namespace
}  // namespace dts::session
