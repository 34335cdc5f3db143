// SPDX-License-Identifier: Apache-2.0
// What the acquisition counts: losses by cause.
#include <gtest/gtest.h>

#include "scripted_device.h"
#include "session/acquisition.h"

namespace dts::session {
namespace {

using device::ReadOutcome;

constexpr std::size_t kCountedScans = 8;

struct Ignore final : ScanSink {
  void process(const core::Acquired&, bool) noexcept override {}
};

/// The report after a script was played.
AcquisitionReport played(std::deque<ScriptedDevice::Step> script) {
  core::VirtualClock clock;
  ScriptedDevice device(std::move(script));
  Ignore sink;
  Acquisition acquisition(device, clock, sink, core::Rate::create(100, 1).value(), kCountedScans);
  device.on_end = [&] { acquisition.request_stop(); };
  acquisition.run();
  return acquisition.report();
}

TEST(AcquisitionCounts, LossesStandUnderTheirCause_AndAddUp) {
  const core::Gap overrun{.reason = core::GapReason::Overrun, .missing_scans = 5, .is_exact = true};
  const core::Gap longer{.reason = core::GapReason::Overrun, .missing_scans = 7, .is_exact = true};
  const AcquisitionReport report = played({{.scans = 3},
                                           {.outcome = ReadOutcome::Gap, .gap = overrun},
                                           {.scans = 2},
                                           {.outcome = ReadOutcome::Gap, .gap = longer},
                                           {.scans = 2},
                                           {.scans = 2, .skip_index = 3}});

  EXPECT_EQ(report.losses.of(core::GapReason::Overrun), (core::LossCount{.gaps = 2, .scans = 12}));
  EXPECT_EQ(report.losses.of(core::GapReason::Integrity), (core::LossCount{.gaps = 1, .scans = 3}));
  EXPECT_EQ(report.losses.total(), (core::LossCount{.gaps = 3, .scans = 15}));
}

}  // namespace
}  // namespace dts::session
