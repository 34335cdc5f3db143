// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "accuracy/capture.h"
#include "accuracy/cases.h"
#include "accuracy/measures.h"
#include "accuracy/recording_file.h"

namespace dts::accuracy {

/// What was published beside what was true.
struct Evaluation {
  std::size_t expected_scans = 0;    ///< Scans whose whole window lies in the case's time.
  std::size_t compared_scans = 0;    ///< Those of them that were published with a finite COP and have a truth.
  std::uint64_t lost_scans = 0;      ///< By device, daemon or socket, from the subscription on.
  std::uint64_t dropped_blocks = 0;  ///< By the daemon's publisher: tells a starved daemon from a starved client.
  std::uint8_t doubts = 0;           ///< Quality bits of the compared blocks.
  double load_error = 0.0;           ///< Mean published over mean true load, minus 1.
  double rate_hz = 0.0;
  Agreement ml;
  Agreement ap;
  Locus published;  ///< `compared_scans` long, and in step: truth[i] is what published[i] should have been.
  Locus truth;
};

/// Pairs the scan k of the COP with the truth at the time of k minus the stream's published delay (half a scan:
/// interpolated). Only windows that lie in the case's time as a whole count. With nothing to compare all figures are 0.
[[nodiscard]] Evaluation evaluate(const Case& wanted, const RigCapture& rig);

/// Largest distance (per axis, mm) of the simulator's truth from the recording it plays, over the case's time.
[[nodiscard]] double largest_truth_error_mm(const Case& wanted, const RigCapture& rig, const RecordingFile& recording);

}  // namespace dts::accuracy
