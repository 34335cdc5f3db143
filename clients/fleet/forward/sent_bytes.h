// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <stop_token>
#include <string>

#include "core/result.h"
#include "fleet/forward/recording_mask.h"
#include "fleet/wire/facts.h"
#include "record/xdf/chunk_stream.h"

namespace dts::fleet::forward {

/// The bytes of a recording that leave the clinic, see RecordingMask: as many as the file has. Reads the file only, chunk by chunk; holds
/// one chunk in memory (0.2 s of data). Thread: one.
class SentBytes {
 public:
  /// Fails as ChunkStream::open does.
  [[nodiscard]] static core::Result<SentBytes> open(const std::string& file, const wire::SendRules& rules);

  /// Returns `count` bytes from `offset`, fewer at the end of the file. Reading forwards is cheap; a smaller offset than the end of the
  /// last call reads the file from its start again. Fails if the file cannot be read or is not whole.
  [[nodiscard]] core::Result<std::string> read(std::uint64_t offset, std::size_t count);
  [[nodiscard]] std::uint64_t size() const noexcept { return stream_->size(); }

 private:
  SentBytes(std::string file, wire::SendRules rules, std::unique_ptr<record::ChunkStream> stream);
  [[nodiscard]] core::Status rewind();

  std::string file_;
  wire::SendRules rules_;
  std::unique_ptr<record::ChunkStream> stream_;
  RecordingMask mask_;
  std::uint64_t begin_ = 0;  ///< Offset of the first byte of `buffer_`.
  std::string buffer_;
};

/// Checksums and size of a recording.
struct Hashes {
  std::string recorded_sha256;  ///< Of the file: 32 bytes.
  std::string sent_sha256;      ///< Of the bytes that leave the clinic: 32 bytes.
  std::uint64_t bytes = 0;
};
/// Reads the whole file once. Fails as SentBytes does, and with Failed if a stop is requested.
[[nodiscard]] core::Result<Hashes> hashes_of(const std::string& file, const wire::SendRules& rules, const std::stop_token& stop);

}  // namespace dts::fleet::forward
