// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "core/result.h"
#include "record/stream_info.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {

/// Content of a samples chunk:
///
///     [stream, u32][length of count: 1, 4, 8][count] then per sample [0 or 8][time stamp, f64, if 8][value]...
///
/// a text being [length of length: 1, 4, 8][length][bytes].

/// `times_s`: of every sample, or of the first only, or of none. Numbers that the type cannot hold become its nearest, undefined ones 0.
[[nodiscard]] std::string encode_samples(std::uint32_t stream, ValueType type, std::size_t channels, std::span<const double> times_s,
                                         std::span<const double> values);
[[nodiscard]] std::string encode_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts);

/// Counts time on where samples have no stamp: from the last stamp there was, over all chunks of a stream.
struct TimeGrid {
  std::optional<core::Rate> rate;
  double given_s = 0.0;           ///< The last stamp in the file.
  std::uint64_t since_given = 0;  ///< Samples since then.

  [[nodiscard]] double next() noexcept;
};

/// What follows the stream's number. Checks the count against the bytes before it takes memory; DataDamaged when it does not fit, when
/// bytes are left over, or when the first time stamp is not a number.
[[nodiscard]] core::Result<Samples> decode_samples(std::string_view content, ValueType type, std::size_t channels, TimeGrid& grid);

}  // namespace dts::record
