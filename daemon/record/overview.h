// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/losses.h"
#include "core/result.h"
#include "record/segment_table.h"
#include "record/session_facts.h"
#include "record/stream_info.h"

namespace dts::record {

/// Result of one pass through a whole recording.
struct Overview {
  std::vector<StreamInfo> streams;
  std::vector<std::uint64_t> sample_counts;
  std::map<std::uint32_t, std::size_t> index_of_number;  ///< From the stream number in the file to the index in `streams`.
  std::optional<SessionFacts> session;
  std::string damage;     ///< Why the file is not whole; empty: it is.
  std::uint64_t end = 0;  ///< End of the last readable chunk, in bytes.
  /// From the events that dtsd recorded; if the file has none, from the time stamps of the reference stream.
  SegmentTable segments;
  bool has_segment_events = false;
  /// Rate of the reference stream: "raw", or the fastest stream without one. Events count its scans.
  std::optional<core::Rate> reference_rate;
  double duration_s = 0.0;  ///< Of the reference stream: from its first scan to the end of its last, gaps included.
  core::Losses losses;      ///< From our events; in files of other programs from the time stamps of the reference stream.
};

/// Fails if the file header cannot be read.
[[nodiscard]] core::Result<Overview> look_through(const std::string& file);

}  // namespace dts::record
