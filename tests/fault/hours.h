// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::fault {

/// A long recording in accelerated time: what came of it.
struct LongRecording {
  double hours = 0.0;
  std::uint64_t scans = 0;
  std::uint64_t bytes = 0;
  std::uint64_t index_bytes = 0;
  double data_bytes = 0.0;      ///< Of the values alone.
  double expected_bytes = 0.0;  ///< By the formula in synthetic_frames.h.
  double took_s = 0.0;
  double verify_s = 0.0;
  long resident_start_kb = 0;  ///< After the first minute of data.
  long resident_end_kb = 0;    ///< Before it is closed.
  std::string problem;         ///< Empty: it opens, verifies and holds every scan.
};

/// Synthetic frames of 16 sensors at 1500 Hz straight into record::Recorder, on a virtual time axis. Covered: the recorder, the writer, the
/// index, the file's size, verification, memory. Not covered: hours of a device, the rings, the threads and the catalogue, whose memory
/// does not depend on how long they run, and a disk that is slow only later.
[[nodiscard]] LongRecording record_hours(double hours, const std::string& folder);

}  // namespace dts::fault
