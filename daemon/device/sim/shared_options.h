// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/sim/option_checks.h"
#include "device/uri_options.h"

/// Options of both the simulated floor and the simulated chair.
namespace dts::device::sim::shared_option {

inline constexpr UriOption kRange{"range_v", OptionKind::Number, "5", 1, 10, "", "Range of the converter, to both sides of 0 V."};
inline constexpr UriOption kClock{
    "clock_ppm", OptionKind::Number, "0", -1000, 1000, "", "Error of the device's clock; positive runs fast."};
inline constexpr UriOption kGainSpread{"gain_spread", OptionKind::Number, "0", 0, 0.5, "", "Sensor gains differ from 1 by up to this."};
inline constexpr UriOption kSensors{
    "sensors", OptionKind::Integer, "0", 0, 32, "", "Number of sensors, counted from the first of the rig; 0: all of them."};
inline constexpr UriOption kFault{"fault", OptionKind::Word, "none", 0, 0, "none|unplug|overrun|stuck|silence", "What goes wrong."};
inline constexpr UriOption kFaultAt{"fault_at_s", OptionKind::Number, "10", 0, 1e6, "", "Device time since start at which it goes wrong."};
inline constexpr UriOption kFaultFor{"fault_for_s", OptionKind::Number, "2", 0.001, 86400, "", "How long the fault lasts."};
inline constexpr UriOption kFaultChannel{"fault_channel", OptionKind::Integer, "0", 0, 31, "", "Channel that fault=stuck holds."};
inline constexpr Dependency kFaultChannelNeeds{"fault_channel", "fault", "stuck"};

}  // namespace dts::device::sim::shared_option
