// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"
#include "record/stream_info.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {

using Facts = std::vector<std::pair<std::string, std::string>>;

/// What a stream's header says beside `StreamInfo`, for readers that look for it.
struct StreamOrigin {
  std::string session_id;
  std::uint32_t stream = 0;
  double created_at_s = 0.0;
};
/// What a stream's footer sums up.
struct StreamSummary {
  double first_time_s = 0.0;
  double last_time_s = 0.0;
  std::uint64_t sample_count = 0;
  std::vector<std::pair<double, double>> clock_offsets{};  ///< (time, offset), at most `kMaxFooterOffsets`.
  Facts facts{};
};
inline constexpr std::size_t kMaxFooterOffsets = 20'000;  ///< A footer is one piece of XML of at most 8 MiB; the chunks have them all.

[[nodiscard]] std::string file_header_xml(const Facts& facts);
[[nodiscard]] std::string stream_header_xml(const StreamInfo& info, const StreamOrigin& origin);
[[nodiscard]] std::string stream_footer_xml(const StreamSummary& summary);

/// Reading. DataDamaged: no XML, more than 8 MiB, a number that is none, a format or a rate that cannot be; Unsupported: not XDF 1.x.
[[nodiscard]] core::Result<FileHeader> file_header_of_xml(std::string_view xml);
[[nodiscard]] core::Result<StreamInfo> stream_info_of_xml(std::string_view xml);
[[nodiscard]] core::Result<StreamFooter> stream_footer_of_xml(std::string_view xml);

/// "double64"
[[nodiscard]] std::string_view name(ValueType type) noexcept;

}  // namespace dts::record
