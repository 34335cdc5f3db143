// SPDX-License-Identifier: Apache-2.0
// Rates that NI's clocks cannot give: refused with one that they can.
#include "unit/device/nidaqmx/ni_rig.h"

namespace dts::device::nidaqmx {
namespace {

using core::ErrorCode;
using test::Rig;
using test::start_error;

TEST(NiDaqmxRate, RateThatTheHintNames_IsTaken) {
  for (const double timebase_hz : {12e6, 20e6, 80e6}) {
    for (const double rate_hz : {1499.0, 1333.7, 977.0, 333.1, 70.03}) {
      Rig rig;
      rig.control.timebase_hz = timebase_hz;
      const core::Error error = start_error(rig, rate_hz);
      const std::string prefix = "configure rate_hz = ";
      ASSERT_EQ(error.hint.rfind(prefix, 0), 0U) << error.hint;

      rig.start(std::stod(error.hint.substr(prefix.size())));

      EXPECT_EQ(rig.read().outcome, ReadOutcome::Scans);
    }
  }
}

TEST(NiDaqmxRate, OtherRate_RefusedNamingTheOneToConfigure) {
  Rig rig;
  rig.control.runs_at_hz = 20e6 / 13'333.0;
  const core::Error error = start_error(rig, 1500);
  EXPECT_EQ(error.code, ErrorCode::InvalidArgument);
  EXPECT_NE(error.hint.find("1500.037500"), std::string::npos) << error.hint;
  EXPECT_EQ(rig.device->state(), DeviceState::Open);

  const auto started = rig.device->start({device::test::rate_of(1500.037500), 64});
  EXPECT_TRUE(started.has_value()) << core::to_string(started.error());
}

}  // namespace
}  // namespace dts::device::nidaqmx
