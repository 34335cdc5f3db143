// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "core/units.h"
#include "record/recording.h"

namespace dts::report {

/// The seat's transient during one trial: the mean deflection of the chair's four sensors.
struct TransientTrace {
  double rate_hz = 0.0;
  double begin_s = 0.0;      ///< Time of the first sample after the cue; negative: before it.
  std::vector<double> mm{};  ///< NaN: missing.
  std::string problem{};     ///< Why there are no samples.

  /// Returns the trace as a mean over 50 ms, as P1, P2 and P3 are found in it; NaN where a sample is missing.
  [[nodiscard]] std::vector<double> smoothed() const;
};

/// Which samples to read: those of [begin, end) of one segment, numbered as the raw stream.
struct TraceWindow {
  std::uint32_t segment = 0;
  core::ScanIndex begin;
  core::ScanIndex cue;
  core::ScanIndex end;
};

/// Reads one trace per window from the stream "transient", from the beginning of the recording. A window longer than 60 s is cut. Fails as
/// reading fails, and with NotFound without the stream.
[[nodiscard]] core::Result<std::vector<TransientTrace>> read_traces(record::Recording& recording, std::span<const TraceWindow> windows,
                                                                    const std::function<void(double)>& progress);

}  // namespace dts::report
