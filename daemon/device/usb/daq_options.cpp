// SPDX-License-Identifier: Apache-2.0
#include "device/usb/daq_options.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "core/block.h"

namespace dts::device::usb {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr double kRangeMatch = 1e-9;

tl::unexpected<core::Error> refuse(const DeviceUri& uri, ErrorCode code, const std::string& why, std::string hint = {}) {
  return core::fail(code, "device \"" + uri.text + "\": " + why, std::move(hint));
}

std::string list_of(std::span<const double> values) {
  std::ostringstream text;
  for (std::size_t i = 0; i < values.size(); ++i) text << (i > 0 ? ", " : "") << values[i];
  return text.str();
}

std::string input_text(double input) {
  std::ostringstream text;
  text << input;
  return text.str();
}

/// Returns the inputs that the user listed, or the first inputs.
std::vector<double> listed_inputs(const UriOptions& options, const DaqLimits& limits, std::optional<double> marker) {
  if (options.is_given("channels")) return options.numbers("channels");
  std::vector<double> inputs;
  for (std::size_t input = 0; input < limits.inputs && inputs.size() + (marker ? 1 : 0) < limits.max_scan_length; ++input) {
    if (static_cast<double>(input) != marker) inputs.push_back(static_cast<double>(input));
  }
  return inputs;
}

core::Status check_inputs(const DeviceUri& uri, const DaqLimits& limits, std::span<const double> inputs) {
  const std::string most = std::to_string(std::min(limits.max_scan_length, core::kMaxChannels));
  if (inputs.size() > std::min(limits.max_scan_length, core::kMaxChannels)) {
    return refuse(uri, ErrorCode::LimitExceeded, std::to_string(inputs.size()) + " channels in a scan, at most " + most);
  }
  for (const double input : inputs) {
    const bool is_input = input >= 0 && input < static_cast<double>(limits.inputs) && input == std::floor(input);
    if (is_input) continue;
    return refuse(uri, ErrorCode::InvalidArgument, "there is no input " + input_text(input),
                  "choose inputs 0 to " + std::to_string(limits.inputs - 1));
  }
  for (std::size_t i = 1; i < inputs.size(); ++i) {
    const bool is_repeated = std::find(inputs.begin(), inputs.begin() + static_cast<std::ptrdiff_t>(i), inputs[i]) !=
                             inputs.begin() + static_cast<std::ptrdiff_t>(i);
    if (is_repeated) {
      return refuse(uri, ErrorCode::InvalidArgument, "input " + input_text(inputs[i]) + " is listed twice in channels");
    }
    if (limits.must_ascend && inputs[i] < inputs[i - 1]) {
      return refuse(uri, ErrorCode::InvalidArgument,
                    "input " + input_text(inputs[i]) + " is listed after " + input_text(inputs[i - 1]) +
                        ", but this device scans its inputs in ascending order",
                    "list channels in ascending order; the marker must be the last, so wire it to the highest input");
    }
  }
  return {};
}

core::Status read_ranges(const DeviceUri& uri, const UriOptions& options, const DaqLimits& limits, DaqOptions& result) {
  const std::size_t channels = result.channels.size();
  result.ranges_v.assign(channels, limits.ranges_v.empty() ? 0.0 : limits.ranges_v.front());
  if (!options.is_given("range_v")) return {};
  const std::vector<double>& given = options.numbers("range_v");
  if (given.size() != 1 && given.size() != channels) {
    return refuse(uri, ErrorCode::InvalidArgument,
                  "range_v has " + std::to_string(given.size()) + " values for " + std::to_string(channels) + " channels",
                  "write one for all, or one for each channel of the scan, the marker included");
  }
  for (std::size_t i = 0; i < channels; ++i) {
    const double wanted = given[given.size() == 1 ? 0 : i];
    const auto found = std::find_if(limits.ranges_v.begin(), limits.ranges_v.end(),
                                    [wanted](double range) { return std::abs(range - wanted) <= kRangeMatch * range; });
    if (found == limits.ranges_v.end()) {
      return refuse(uri, ErrorCode::InvalidArgument, "there is no range of +-" + input_text(wanted) + " V",
                    "allowed: range_v = " + list_of(limits.ranges_v));
    }
    result.ranges_v[i] = *found;
  }
  return {};
}

core::Status read_marker(const DeviceUri& uri, const UriOptions& options, DaqOptions& result) {
  const Marker marker{result.channels.size() - 1, options.number("marker_v"), options.number("marker_tolerance_v")};
  if (result.channels.size() < 2) return refuse(uri, ErrorCode::InvalidArgument, "the marker is the only input in channels");
  const double range_v = result.ranges_v[marker.position];
  if (std::abs(marker.volts) + marker.tolerance_v > range_v) {
    return refuse(uri, ErrorCode::InvalidArgument,
                  "marker_v with marker_tolerance_v is not within the marker's range of +-" + input_text(range_v) + " V");
  }
  result.marker = marker;
  return {};
}

core::Status check_dependencies(const DeviceUri& uri, const UriOptions& options) {
  const bool has_marker = options.number("marker") >= 0;
  for (const std::string_view option : {"marker_v", "marker_tolerance_v"}) {
    if (!options.is_given(option) || has_marker) continue;
    return refuse(uri, ErrorCode::InvalidArgument, std::string(option) + " has an effect only with marker=INPUT");
  }
  if (!has_marker || options.is_given("marker_v")) return {};
  return refuse(uri, ErrorCode::InvalidArgument, "marker=" + input_text(options.number("marker")) + " needs marker_v=...",
                "write the voltage that this input is wired to; it must differ from every voltage that the other inputs can have");
}

}  // namespace

std::vector<UriOption> common_daq_options() {
  return {
      {"serial", Text, "", 0, 0, "", "Serial number of the unit; needed when several are plugged in."},
      {"channels", Numbers, "", 0, 255, "", "Inputs to scan, in this order; default: all that a scan can hold."},
      {"range_v", Numbers, "", 0.001, 100, "", "Range to both sides of 0 V: one for all channels, or one for each."},
      {"marker", Integer, "-1", -1, 255, "",
       "Input wired to a known voltage, the last of every scan: it shows immediately when a sample was lost. -1: none."},
      {"marker_v", Number, "0", -100, 100, "", "Voltage at the marker."},
      {"marker_tolerance_v", Number, "0.1", 0.001, 10, "", "How far a marker may be off."},
  };
}

core::Result<DaqOptions> read_daq_options(const DeviceUri& uri, const UriOptions& options, const DaqLimits& limits) {
  DTS_TRY(check_dependencies(uri, options));
  std::optional<double> marker;
  if (options.number("marker") >= 0) marker = options.number("marker");

  std::vector<double> inputs = listed_inputs(options, limits, marker);
  if (marker) {
    const auto listed = std::find(inputs.begin(), inputs.end(), *marker);
    if (listed == inputs.end()) {
      inputs.push_back(*marker);
    } else if (listed + 1 != inputs.end()) {
      return refuse(uri, ErrorCode::InvalidArgument, "marker " + input_text(*marker) + " is not the last of channels");
    }
  }
  DTS_TRY(check_inputs(uri, limits, inputs));

  DaqOptions result;
  result.uri = uri.text;
  result.serial = options.text("serial");
  for (const double input : inputs) result.channels.push_back(static_cast<std::size_t>(input));
  DTS_TRY(read_ranges(uri, options, limits, result));
  if (!marker) return result;
  DTS_TRY(read_marker(uri, options, result));
  return result;
}

}  // namespace dts::device::usb
