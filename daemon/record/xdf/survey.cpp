// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/survey.h"

#include <sodium.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "record/xdf/byte_codec.h"
#include "record/xdf/chunk_decoder.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/chunk_stream.h"
#include "record/xdf/durable_file.h"

namespace dts::record {
namespace {

constexpr std::uint64_t kProgressBytes = 8U << 20U;

core::Error damaged(const std::string& what, std::uint64_t offset) {
  return {core::ErrorCode::DataDamaged, what + " at byte " + std::to_string(offset), {}};
}

class Surveyor {
 public:
  Surveyor(std::unique_ptr<ChunkStream> stream, std::string file)
      : stream_(std::move(stream)), file_(std::move(file)), index_(index_name(file_)) {
    crypto_hash_sha256_init(&hash_);
    hash(kMagic);
    survey_.size = stream_->size();
    survey_.end = stream_->offset();
    survey_.is_all_indexed = index_.is_open();
  }

  core::Result<Survey> run(const Progress& progress);

 private:
  /// Reads the next chunk; returns false at the end of the file or at a fault.
  bool step();
  bool fits_index(const RawChunk& raw);
  void finish_index();
  void add(const Chunk& chunk);
  void add_samples(const Samples& samples);
  void hash(std::string_view bytes) noexcept {
    crypto_hash_sha256_update(&hash_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  }

  std::unique_ptr<ChunkStream> stream_;
  std::string file_;
  IndexReader index_;
  ChunkDecoder decoder_;
  crypto_hash_sha256_state hash_{};
  Survey survey_;
};

core::Result<Survey> Surveyor::run(const Progress& progress) {
  ProgressMeter meter(progress, survey_.size);
  while (step()) DTS_TRY(meter.advance(survey_.end));
  finish_index();
  survey_.sha256 = hexadecimal_sha256(hash_);
  return std::move(survey_);
}

bool Surveyor::step() {
  const auto raw = stream_->next();
  if (!raw) survey_.fault = raw.error();
  if (!raw || !*raw) return false;
  if (!fits_index(**raw)) return false;
  const auto chunk = decoder_.decode(**raw);
  if (!chunk) {
    survey_.fault = chunk.error();
    return false;
  }
  add(*chunk);
  hash((*raw)->bytes);
  survey_.end = stream_->offset();
  ++survey_.chunks;
  return true;
}

/// Compares a chunk with the index. A wrong checksum is a fault of the chunk. A wrong offset or length is a fault of the index: if the
/// chunk's length were damaged, its content could not be decoded.
bool Surveyor::fits_index(const RawChunk& raw) {
  const auto note = index_.next();
  if (!note) {
    survey_.is_all_indexed = false;
    return true;
  }
  survey_.indexed_end = note->offset + note->length;
  if (survey_.index_fault) return true;
  if (note->offset != raw.offset || note->length != raw.bytes.size()) {
    survey_.index_fault = damaged("the index does not fit the file", raw.offset);
    survey_.is_all_indexed = false;
    return true;
  }
  if (note->crc32c == crc32c(raw.bytes)) return true;
  survey_.fault = damaged("checksum wrong", raw.offset);
  return false;
}

void Surveyor::finish_index() {
  while (const auto note = index_.next()) survey_.indexed_end = note->offset + note->length;
  if (survey_.index_fault) survey_.indexed_end = 0;  // a wrong index is not trusted
  std::error_code unknown;
  const std::uint64_t size_now = std::filesystem::file_size(file_, unknown);
  if (!unknown && size_now >= survey_.indexed_end)
    survey_.indexed_end = std::min(survey_.indexed_end, survey_.size);  // the file is being written
  const bool is_longer = survey_.indexed_end > survey_.size;
  if (is_longer && !survey_.fault)
    survey_.index_fault =
        damaged("the index lists " + std::to_string(survey_.indexed_end - survey_.size) + " bytes more than the file has", survey_.size);
}

void Surveyor::add(const Chunk& chunk) {
  if (std::holds_alternative<FileHeader>(chunk.content)) survey_.has_file_header = true;
  if (const auto* header = std::get_if<StreamHeader>(&chunk.content)) {
    const auto& info = header->info;
    survey_.streams[header->stream] = {.name = info.name, .scan_s = info.rate ? 1.0 / info.rate->hz() : 0.0};
  }
  if (const auto* footer = std::get_if<StreamFooter>(&chunk.content)) survey_.streams[footer->stream].footer = *footer;
  if (const auto* samples = std::get_if<Samples>(&chunk.content)) add_samples(*samples);
}

void Surveyor::add_samples(const Samples& samples) {
  if (samples.times_s.empty()) return;
  auto& stream = survey_.streams[samples.stream];
  if (stream.samples == 0) stream.first_time_s = samples.times_s.front();
  stream.last_time_s = samples.times_s.back();
  stream.samples += samples.times_s.size();
}

}  // namespace

bool Survey::is_closed() const noexcept {
  return has_file_header && !fault && indexed_end <= size &&
         std::ranges::all_of(streams, [](const auto& stream) { return stream.second.footer.has_value(); });
}

const StreamSurvey* Survey::longest_stream() const noexcept {
  const auto rank = [](const StreamSurvey& stream) { return std::pair(stream.samples > 0 && stream.scan_s > 0.0, stream.samples); };
  const StreamSurvey* longest = nullptr;
  for (const auto& [number, stream] : streams) {
    if (stream.samples > 0 && (longest == nullptr || rank(stream) > rank(*longest))) longest = &stream;
  }
  return longest;
}

double Survey::duration_s() const noexcept {
  const StreamSurvey* const stream = longest_stream();
  const double duration_s = stream != nullptr ? stream->last_time_s - stream->first_time_s + stream->scan_s : 0.0;
  return std::isfinite(duration_s) && duration_s > 0.0 ? duration_s : 0.0;
}

std::string Survey::footer_fact(const std::string& name) const {
  for (const auto& [number, stream] : streams) {
    if (!stream.footer) continue;
    if (auto text = fact(stream.footer->facts, name); !text.empty()) return text;
  }
  return {};
}

core::Status ProgressMeter::advance(std::uint64_t done) {
  if (!progress_ || (done < of_ && done - reported_ < kProgressBytes)) return {};
  reported_ = done;
  if (progress_(done, of_)) return {};
  return core::fail(core::ErrorCode::Failed, "stopped at " + std::to_string(done) + " of " + std::to_string(of_) + " bytes");
}

core::Result<Survey> survey(const std::string& file, const Progress& progress) {
  DTS_TRY_ASSIGN(auto stream, ChunkStream::open(file));
  return Surveyor(std::move(stream), file).run(progress);
}

}  // namespace dts::record
