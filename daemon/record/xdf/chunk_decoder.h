// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>

#include "core/result.h"
#include "record/xdf/chunk_stream.h"
#include "record/xdf/samples_codec.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {

/// Decodes chunks in file order. The order matters: a samples chunk needs its stream's header, and its times need the previous chunks.
class ChunkDecoder {
 public:
  /// Fails with DataDamaged, or with Unsupported for another version of XDF; the message contains the chunk's offset.
  [[nodiscard]] core::Result<Chunk> decode(const RawChunk& raw);

 private:
  struct Stream {
    ValueType type = ValueType::Double64;
    std::size_t channels = 1;
    TimeGrid grid{};
  };
  [[nodiscard]] core::Status decode_content(const RawChunk& raw, Chunk& chunk);
  [[nodiscard]] core::Status decode_file_header(std::string_view xml, Chunk& chunk);
  [[nodiscard]] core::Status decode_stream_header(std::uint32_t number, std::string_view xml, Chunk& chunk);
  [[nodiscard]] core::Status decode_of_stream(ChunkTag tag, std::string_view content, Chunk& chunk);

  std::map<std::uint32_t, Stream> streams_;
  std::uint64_t header_bytes_ = 0;
  bool has_file_header_ = false;
};

}  // namespace dts::record
