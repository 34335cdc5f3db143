// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/chunk_decoder.h"

#include "record/damaged.h"
#include "record/xdf/byte_codec.h"
#include "record/xdf/header_xml.h"

namespace dts::record {
namespace {

/// Limit of all headers together: readers keep them in memory, and a file could consist of headers only.
constexpr std::uint64_t kMaxHeaderBytes = 64U << 20U;
constexpr std::size_t kMaxStreams = 4096;

std::string part_name(std::uint16_t tag) {
  switch (static_cast<ChunkTag>(tag)) {
    case ChunkTag::FileHeader: return "file header";
    case ChunkTag::StreamHeader: return "stream header";
    case ChunkTag::Samples: return "samples";
    case ChunkTag::ClockOffset: return "clock offset";
    case ChunkTag::Boundary: return "boundary";
    case ChunkTag::StreamFooter: return "stream footer";
  }
  return "chunk of tag " + std::to_string(tag);
}

/// Moves the decoded content into the chunk.
template <class Content>
core::Status keep(core::Result<Content> content, Chunk& chunk) {
  if (!content) return tl::make_unexpected(content.error());
  chunk.content = std::move(*content);
  return {};
}

}  // namespace

core::Result<Chunk> ChunkDecoder::decode(const RawChunk& raw) {
  Chunk chunk{.offset = raw.offset, .length = raw.bytes.size(), .content = UnknownChunk{raw.tag}};
  const auto status = decode_content(raw, chunk);
  if (status) return chunk;
  const auto& error = status.error();
  return core::fail(error.code, part_name(raw.tag) + " damaged at byte " + std::to_string(raw.offset) + ": " + error.what, error.hint);
}

core::Status ChunkDecoder::decode_content(const RawChunk& raw, Chunk& chunk) {
  const auto tag = static_cast<ChunkTag>(raw.tag);
  if (has_file_header_ == (tag == ChunkTag::FileHeader))
    return core::fail(kDamaged, has_file_header_ ? "a second one" : "a file starts with a file header");
  switch (tag) {
    case ChunkTag::FileHeader: return decode_file_header(raw.content, chunk);
    case ChunkTag::StreamHeader:
    case ChunkTag::Samples:
    case ChunkTag::ClockOffset:
    case ChunkTag::StreamFooter: return decode_of_stream(tag, raw.content, chunk);
    case ChunkTag::Boundary: chunk.content = Boundary{}; return {};
  }
  return {};
}

core::Status ChunkDecoder::decode_file_header(std::string_view xml, Chunk& chunk) {
  auto status = keep(file_header_of_xml(xml), chunk);
  has_file_header_ = status.has_value();
  return status;
}

core::Status ChunkDecoder::decode_stream_header(std::uint32_t number, std::string_view xml, Chunk& chunk) {
  if (streams_.contains(number)) return core::fail(kDamaged, "a second header of stream " + std::to_string(number));
  header_bytes_ += xml.size();
  if (header_bytes_ > kMaxHeaderBytes || streams_.size() >= kMaxStreams) return core::fail(kDamaged, "too many streams");
  DTS_TRY_ASSIGN(auto info, stream_info_of_xml(xml));
  streams_.emplace(number, Stream{.type = info.value_type, .channels = info.channels.size(), .grid = {.rate = info.rate}});
  chunk.content = StreamHeader{.stream = number, .info = std::move(info)};
  return {};
}

core::Status ChunkDecoder::decode_of_stream(ChunkTag tag, std::string_view content, Chunk& chunk) {
  ByteCursor cursor(content);
  std::uint32_t number = 0;
  if (!cursor.read(number)) return core::fail(kDamaged, "no stream number");
  if (tag == ChunkTag::StreamHeader) return decode_stream_header(number, cursor.left(), chunk);
  const auto stream = streams_.find(number);
  if (stream == streams_.end()) return core::fail(kDamaged, "stream " + std::to_string(number) + " has no header");
  if (tag == ChunkTag::ClockOffset) {
    ClockOffset offset{.stream = number};
    if (!cursor.read(offset.stream_time_s) || !cursor.read(offset.offset_s) || !cursor.left().empty())
      return core::fail(kDamaged, "not two numbers");
    chunk.content = offset;
    return {};
  }
  if (tag == ChunkTag::StreamFooter) {
    auto footer = stream_footer_of_xml(cursor.left());
    if (footer) footer->stream = number;
    return keep(std::move(footer), chunk);
  }
  auto samples = decode_samples(cursor.left(), stream->second.type, stream->second.channels, stream->second.grid);
  if (samples) samples->stream = number;
  return keep(std::move(samples), chunk);
}

}  // namespace dts::record
