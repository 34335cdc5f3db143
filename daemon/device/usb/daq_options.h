// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "device/uri_options.h"

namespace dts::device::usb {

/// A channel wired to a known voltage, last in every scan: a wrong voltage means that the channels are rotated.
struct Marker {
  std::size_t position = 0;  ///< Position in the scan: the last.
  double volts = 0.0;
  double tolerance_v = 0.1;
};

/// The URI options that every USB DAQ has.
struct DaqOptions {
  std::string uri;
  std::string serial;                 ///< Empty: the only plugged-in unit.
  std::vector<std::size_t> channels;  ///< Input at each position of the scan.
  std::vector<double> ranges_v;       ///< Range at each position: +- this value.
  std::optional<Marker> marker;
};

/// Limits of a family of DAQs.
struct DaqLimits {
  std::size_t inputs = 8;
  std::size_t max_scan_length = 8;
  bool must_ascend = true;           ///< The device scans its inputs in ascending order only.
  std::span<const double> ranges_v;  ///< Allowed ranges, the default first.
};

/// Returns serial, channels, range_v, marker, marker_v, marker_tolerance_v; a family appends its own options.
[[nodiscard]] std::vector<UriOption> common_daq_options();

/// Reads these options. Fails with InvalidArgument or LimitExceeded, naming the option and the allowed values.
[[nodiscard]] core::Result<DaqOptions> read_daq_options(const DeviceUri& uri, const UriOptions& options, const DaqLimits& limits);

}  // namespace dts::device::usb
