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

/// Content of a stream's header that is not in `StreamInfo`: only other readers use it.
struct StreamOrigin {
  std::string session_id;
  std::uint32_t stream = 0;
  double created_at_s = 0.0;
};
/// Content of a stream's footer.
struct StreamSummary {
  double first_time_s = 0.0;
  double last_time_s = 0.0;
  std::uint64_t sample_count = 0;
  std::vector<std::pair<double, double>> clock_offsets{};  ///< (time, offset), at most `kMaxFooterOffsets`.
  Facts facts{};
};
inline constexpr std::size_t kMaxFooterOffsets = 20'000;  ///< A footer is one XML text of at most 8 MiB; the chunks hold all offsets.

[[nodiscard]] std::string file_header_xml(const Facts& facts);
[[nodiscard]] std::string stream_header_xml(const StreamInfo& info, const StreamOrigin& origin);
[[nodiscard]] std::string stream_footer_xml(const StreamSummary& summary);

/// Read a header or footer. Fail with DataDamaged if the text is no XML, has more than 8 MiB, or holds an invalid number, format or rate,
/// and with Unsupported if the version is not XDF 1.x.
[[nodiscard]] core::Result<FileHeader> file_header_of_xml(std::string_view xml);
[[nodiscard]] core::Result<StreamInfo> stream_info_of_xml(std::string_view xml);
[[nodiscard]] core::Result<StreamFooter> stream_footer_of_xml(std::string_view xml);

/// Returns XDF's word for the type: "double64".
[[nodiscard]] std::string_view name(ValueType type) noexcept;

}  // namespace dts::record
