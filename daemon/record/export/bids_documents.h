// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "record/recording.h"

namespace dts::record {

/// Facts about a stream's file that are known only after it was written.
struct MotionFacts {
  std::string tracking_system;  ///< "floorcop"
  std::uint64_t scans = 0;
  std::int64_t duration_ns = 0;  ///< From the first scan to the end of the last, gaps included.
};

/// Return the documents of a BIDS dataset (BIDS 1.9, "Motion").
[[nodiscard]] std::string dataset_description(const std::string& software);
/// Returns true if this program made the dataset. Recordings are added only to such datasets.
[[nodiscard]] bool is_our_dataset(const std::string& description);
[[nodiscard]] std::string dataset_readme();
[[nodiscard]] std::string participants_description();
[[nodiscard]] std::string channels_table(const StreamInfo& stream);
[[nodiscard]] std::string channels_description();
[[nodiscard]] std::string motion_description(const Recording& recording, const StreamInfo& stream, const MotionFacts& facts);
[[nodiscard]] std::string events_description();

}  // namespace dts::record
