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
/// A text is [length of length: 1, 4, 8][length][bytes].

/// `times_s` holds the time of every sample, of the first only, or of none. Replaces a number outside the type's range by the nearest in
/// it, and NaN by 0 in integer types.
[[nodiscard]] std::string encode_samples(std::uint32_t stream, ValueType type, std::size_t channels, std::span<const double> times_s,
                                         std::span<const double> values);
[[nodiscard]] std::string encode_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts);

/// Computes the times of samples without a time stamp from the last time stamp, across all chunks of a stream.
struct TimeGrid {
  std::optional<core::Rate> rate;
  double given_s = 0.0;           ///< The last time stamp in the file.
  std::uint64_t since_given = 0;  ///< Samples since that time stamp.

  [[nodiscard]] double next() noexcept;
};

/// Decodes the content after the stream's number. Checks the count against the bytes before it allocates memory. Fails with DataDamaged if
/// the count does not fit, if bytes are left over, or if the first time stamp is not a number.
[[nodiscard]] core::Result<Samples> decode_samples(std::string_view content, ValueType type, std::size_t channels, TimeGrid& grid);

}  // namespace dts::record
