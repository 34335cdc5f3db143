// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/session_facts.h"

namespace dts::fault {

/// What a recording holds of the raw stream.
struct RecordedRaw {
  /// Consecutive scans.
  struct Run {
    std::uint32_t segment = 0;
    std::size_t first_scan = 0;
    std::vector<double> values{};  ///< Scan by scan.
  };
  std::size_t channels = 0;
  std::vector<Run> runs;
  std::uint64_t scans = 0;
  double first_time_s = 0.0;
  double last_time_s = 0.0;  ///< Of the last scan: CLOCK_MONOTONIC.
  std::uint64_t losses = 0;  ///< Events that say so.
  std::string damage;
  record::SessionFacts facts{};
};

/// Reads it with our own reader; fails as that does, and when the file does not know its session.
[[nodiscard]] core::Result<RecordedRaw> read_raw(const std::string& file);

/// Opens a file with libxdf, another's reader, and compares its raw stream with ours; empty: they agree. Not under the address sanitizer:
/// libxdf reads beyond its own buffers there.
[[nodiscard]] std::string check_with_libxdf(const std::string& file, const RecordedRaw& ours);

}  // namespace dts::fault
