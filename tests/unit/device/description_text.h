// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <sstream>
#include <string>

#include "device/device.h"

namespace dts::device::test {

/// All that a description says, one line for the device and one for neighbours that differ in their names only.
inline std::string text_of(const DeviceDescription& is, const std::string& indent = "") {
  constexpr std::array kRoles = {"sensor", "auxiliary", "marker"};
  std::ostringstream text;
  text.precision(12);
  text << indent << is.model << " '" << is.serial << "', " << is.minimum_rate_hz << " to " << is.maximum_rate_hz << " Hz"
       << (is.has_sync_output ? ", sync output" : "") << (is.waits_for_reader ? ", waits" : "") << '\n';
  std::string last;
  for (const ChannelDescription& channel : is.channels) {
    std::ostringstream line;
    line.precision(12);
    line << ' ' << kRoles.at(static_cast<std::size_t>(channel.role)) << " : " << channel.minimum << " to " << channel.maximum << " '"
         << channel.unit << "' by " << channel.resolution << '\n';
    text << (line.str() == last ? " " : last + indent) << channel.name;
    last = line.str();
  }
  text << last;
  return text.str();
}

inline std::string text_of(const DeviceReport& report) {
  constexpr std::array kOutcomes = {"", "passed", "warning", "failed", "skipped"};
  std::string text = "serial '" + report.serial + "', firmware '" + report.firmware + "'";
  for (const std::string& node : report.nodes) text += ", " + node;
  for (const DeviceCheck& check : report.checks) {
    text += "\n" + check.name + ": " + kOutcomes.at(static_cast<std::size_t>(check.outcome)) + ": " + check.detail;
  }
  return text + "\n";
}

}  // namespace dts::device::test
