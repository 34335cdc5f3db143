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

/// What one look through a whole recording finds.
struct Overview {
  std::vector<StreamInfo> streams;
  std::vector<std::uint64_t> sample_counts;
  std::map<std::uint32_t, std::size_t> index_of_number;  ///< Of a stream in the file.
  std::optional<SessionFacts> session;
  std::string damage;
  std::uint64_t end = 0;  ///< Where the last chunk ends that makes sense.
  /// From our events, or else from the time stamps of the stream that `reference_rate` is of.
  SegmentTable segments;
  bool has_segment_events = false;
  std::optional<core::Rate> reference_rate;  ///< Of "raw", or of the fastest stream: what events count in.
  double duration_s = 0.0;                   ///< Of the same stream: from its first scan to the end of its last, gaps included.
  core::Losses losses;                       ///< From our events; of other programs' files from the time stamps of that stream.
};

/// Fails when not even the file header can be read.
[[nodiscard]] core::Result<Overview> look_through(const std::string& file);

}  // namespace dts::record
