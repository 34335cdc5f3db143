// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/samples_codec.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "record/damaged.h"

namespace dts::record {
namespace {

/// Most memory for one decoded chunk: a malicious chunk may consist of the shortest possible samples.
constexpr std::uint64_t kMaxDecodedBytes = 4 * kMaxChunkBytes;

template <class Number>
void put_value(std::string& bytes, double value) {
  if constexpr (std::is_floating_point_v<Number>) {
    constexpr double kHighest = std::numeric_limits<Number>::max();
    put(bytes, static_cast<Number>(std::isfinite(value) ? std::clamp(value, -kHighest, kHighest) : value));
  } else {
    constexpr Number kLowest = std::numeric_limits<Number>::min();
    constexpr Number kHighest = std::numeric_limits<Number>::max();
    const double rounded = std::isnan(value) ? 0.0 : std::round(value);
    // For 64 bits, kHighest is not a double and converts to the next double above it, which does not fit the type. So >=, not >.
    if (rounded >= static_cast<double>(kHighest)) return put(bytes, kHighest);
    if (rounded <= static_cast<double>(kLowest)) return put(bytes, kLowest);
    put(bytes, static_cast<Number>(rounded));
  }
}

void put_stamp(std::string& bytes, std::span<const double> times_s, std::size_t sample) {
  const bool has_stamp = sample < times_s.size();
  put(bytes, std::uint8_t{has_stamp ? std::uint8_t{8} : std::uint8_t{0}});
  if (has_stamp) put(bytes, times_s[sample]);
}

template <class Number>
void put_samples(std::string& bytes, std::size_t channels, std::span<const double> times_s, std::span<const double> values) {
  const std::size_t count = values.size() / channels;
  bytes.reserve(bytes.size() + count * (channels * sizeof(Number) + 1 + sizeof(double)));
  for (std::size_t sample = 0; sample < count; ++sample) {
    put_stamp(bytes, times_s, sample);
    for (const double value : values.subspan(sample * channels, channels)) put_value<Number>(bytes, value);
  }
}

core::Status read_stamp(ByteCursor& cursor, Samples& samples, TimeGrid& grid) {
  std::uint8_t stamp_bytes = 0;
  if (!cursor.read(stamp_bytes) || (stamp_bytes != 0 && stamp_bytes != 8))
    return core::fail(kDamaged, "a time stamp of neither 0 nor 8 bytes");
  const bool is_first = samples.times_s.empty();
  if (stamp_bytes == 8) {
    double time_s = 0.0;
    if (!cursor.read(time_s)) return core::fail(kDamaged, "samples end within a time stamp");
    if (is_first && std::isnan(time_s)) return core::fail(kDamaged, "the first time stamp is not a number");
    grid.given_s = time_s;
    grid.since_given = 0;
    samples.times_s.push_back(time_s);
  } else {
    samples.times_s.push_back(grid.next());
  }
  if (is_first) samples.has_first_time = stamp_bytes == 8;
  return {};
}

template <class Number>
core::Status read_values(ByteCursor& cursor, Samples& samples, std::size_t channels) {
  for (std::size_t channel = 0; channel < channels; ++channel) {
    Number value{};
    if (!cursor.read(value)) return core::fail(kDamaged, "samples end within a value");
    samples.values.push_back(static_cast<double>(value));
  }
  return {};
}

core::Status read_texts(ByteCursor& cursor, Samples& samples, std::size_t channels) {
  for (std::size_t channel = 0; channel < channels; ++channel) {
    std::uint64_t length = 0;
    std::string_view text;
    if (!cursor.read_length(length) || !cursor.read_text(length, text)) return core::fail(kDamaged, "samples end within a text");
    samples.texts.emplace_back(text);
  }
  return {};
}

struct Layout {
  std::uint64_t value_bytes = 0;    ///< Fewest bytes of a value in the file.
  std::uint64_t decoded_bytes = 0;  ///< Bytes of a value in memory.
  core::Status (*read)(ByteCursor&, Samples&, std::size_t) = nullptr;
};

Layout layout_of(ValueType type) noexcept {
  switch (type) {
    case ValueType::Float32: return {4, sizeof(double), read_values<float>};
    case ValueType::Double64: return {8, sizeof(double), read_values<double>};
    case ValueType::Int8: return {1, sizeof(double), read_values<std::int8_t>};
    case ValueType::Int16: return {2, sizeof(double), read_values<std::int16_t>};
    case ValueType::Int32: return {4, sizeof(double), read_values<std::int32_t>};
    case ValueType::Int64: return {8, sizeof(double), read_values<std::int64_t>};
    case ValueType::Text: break;
  }
  return {2, sizeof(std::string), read_texts};
}

/// Rejects a declared count that the bytes cannot hold, before memory is allocated for it.
core::Status check_count(std::uint64_t count, std::size_t bytes_left, const Layout& layout, std::size_t channels) {
  const std::uint64_t sample_bytes = 1 + channels * layout.value_bytes;
  if (count > bytes_left / sample_bytes)
    return core::fail(kDamaged,
                      std::to_string(count) + " samples declared, but the chunk has room for " + std::to_string(bytes_left / sample_bytes));
  if (count * (sizeof(double) + channels * layout.decoded_bytes) > kMaxDecodedBytes)
    return core::fail(kDamaged, std::to_string(count) + " samples in one chunk are too many to hold");
  return {};
}

}  // namespace

std::string encode_samples(std::uint32_t stream, ValueType type, std::size_t channels, std::span<const double> times_s,
                           std::span<const double> values) {
  std::string content;
  put(content, stream);
  put_length(content, values.size() / channels);
  switch (type) {
    case ValueType::Float32: put_samples<float>(content, channels, times_s, values); break;
    case ValueType::Double64: put_samples<double>(content, channels, times_s, values); break;
    case ValueType::Int8: put_samples<std::int8_t>(content, channels, times_s, values); break;
    case ValueType::Int16: put_samples<std::int16_t>(content, channels, times_s, values); break;
    case ValueType::Int32: put_samples<std::int32_t>(content, channels, times_s, values); break;
    case ValueType::Int64: put_samples<std::int64_t>(content, channels, times_s, values); break;
    case ValueType::Text: break;
  }
  return content;
}

std::string encode_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts) {
  std::string content;
  put(content, stream);
  put_length(content, texts.size());
  for (const auto& [time_s, text] : texts) {
    put(content, std::uint8_t{8});
    put(content, time_s);
    put_length(content, text.size());
    content.append(text);
  }
  return content;
}

double TimeGrid::next() noexcept {
  if (!rate) return given_s;
  ++since_given;
  return given_s + static_cast<double>(since_given) * static_cast<double>(rate->denominator()) / static_cast<double>(rate->numerator());
}

core::Result<Samples> decode_samples(std::string_view content, ValueType type, std::size_t channels, TimeGrid& grid) {
  ByteCursor cursor(content);
  std::uint64_t count = 0;
  if (!cursor.read_length(count)) return core::fail(kDamaged, "no count of samples");
  const Layout layout = layout_of(type);
  DTS_TRY(check_count(count, cursor.left().size(), layout, channels));
  Samples samples;
  samples.times_s.reserve(static_cast<std::size_t>(count));
  if (type == ValueType::Text) {
    samples.texts.reserve(static_cast<std::size_t>(count) * channels);
  } else {
    samples.values.reserve(static_cast<std::size_t>(count) * channels);
  }
  for (std::uint64_t sample = 0; sample < count; ++sample) {
    DTS_TRY(read_stamp(cursor, samples, grid));
    DTS_TRY(layout.read(cursor, samples, channels));
  }
  if (!cursor.left().empty()) return core::fail(kDamaged, std::to_string(cursor.left().size()) + " bytes left over after the samples");
  return samples;
}

}  // namespace dts::record
