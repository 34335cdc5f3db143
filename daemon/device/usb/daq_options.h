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

/// Wired to a known voltage and last in every scan: when it is off, the channels are rotated.
struct Marker {
  std::size_t position = 0;  ///< In the scan: the last.
  double volts = 0.0;
  double tolerance_v = 0.1;
};

/// What every USB DAQ can be asked in its URI.
struct DaqOptions {
  std::string uri;
  std::string serial;                 ///< Empty: the only one that is plugged in.
  std::vector<std::size_t> channels;  ///< Input of each position of the scan.
  std::vector<double> ranges_v;       ///< Per position: +-this.
  std::optional<Marker> marker;
};

/// What a family allows.
struct DaqLimits {
  std::size_t inputs = 8;
  std::size_t max_scan_length = 8;
  bool must_ascend = true;           ///< The device scans its inputs in ascending order only.
  bool may_repeat = false;           ///< An input may stand twice in the scan.
  std::span<const double> ranges_v;  ///< Allowed ones, the default first.
};

/// serial, channels, range_v, marker, marker_v, marker_tolerance_v: put a family's own options behind them.
[[nodiscard]] std::vector<UriOption> common_daq_options();

/// Reads them; fails with InvalidArgument or LimitExceeded naming the option and what is allowed.
[[nodiscard]] core::Result<DaqOptions> read_daq_options(const DeviceUri& uri, const UriOptions& options, const DaqLimits& limits);

}  // namespace dts::device::usb
