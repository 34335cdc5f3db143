// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/xdf_reader.h"

#include "record/xdf/chunk_decoder.h"
#include "record/xdf/chunk_stream.h"

namespace dts::record {
namespace {

class FileReader : public XdfReader {
 public:
  explicit FileReader(std::unique_ptr<ChunkStream> stream) noexcept : stream_(std::move(stream)), offset_(stream_->offset()) {}

  core::Result<std::optional<Chunk>> next() override {
    if (error_) return tl::make_unexpected(*error_);
    const auto raw = stream_->next();
    if (!raw) return keep(raw.error());
    if (!*raw) return std::optional<Chunk>();
    auto chunk = decoder_.decode(**raw);
    if (!chunk) return keep(chunk.error());
    offset_ = stream_->offset();
    return std::optional<Chunk>(std::move(*chunk));
  }
  [[nodiscard]] std::uint64_t offset() const noexcept override { return offset_; }
  [[nodiscard]] std::uint64_t size() const noexcept override { return stream_->size(); }

 private:
  tl::unexpected<core::Error> keep(const core::Error& error) {
    error_ = error;
    return tl::make_unexpected(error);
  }

  std::unique_ptr<ChunkStream> stream_;
  ChunkDecoder decoder_;
  std::optional<core::Error> error_;
  std::uint64_t offset_;  ///< End of the last readable chunk. `stream_->offset()` can be later: after a whole chunk with invalid content.
};

}  // namespace

core::Result<std::unique_ptr<XdfReader>> XdfReader::open(const std::string& file) {
  DTS_TRY_ASSIGN(auto stream, ChunkStream::open(file));
  return std::make_unique<FileReader>(std::move(stream));
}

}  // namespace dts::record
