// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/recovery.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "record/xdf/byte_codec.h"
#include "record/xdf/chunk_decoder.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/chunk_stream.h"
#include "record/xdf/durable_file.h"
#include "record/xdf/header_xml.h"
#include "record/xdf/number_text.h"
#include "record/xdf/survey.h"

namespace dts::record {
namespace {

constexpr std::string_view kRecording = ".xdf";
constexpr std::string_view kRecovered = ".recovered.xdf";

/// Facts for the footers of the copy.
struct Ending {
  std::string reason;
  std::string incomplete;
  double lost_s_at_most = 0.0;
};

/// Estimates the lost time: the removed bytes at the mean byte rate of the kept ones, plus the longest time of data that was not yet in the
/// file or not yet on the disk.
Ending ending_of(const Survey& found) {
  const std::string noted = found.footer_fact("incomplete");
  if (found.is_closed() && !found.streams.empty()) return {.reason = "closed, but not renamed", .incomplete = noted};
  Ending ending{.reason = found.fault ? found.fault->what : "no footer"};
  ending.incomplete = noted.empty() ? ending.reason : noted + "; " + ending.reason;
  const auto lost_bytes = static_cast<double>(std::max(found.size, found.indexed_end) - found.end);
  const double lost_s = lost_bytes * found.duration_s() / static_cast<double>(std::max<std::uint64_t>(found.end, 1));
  ending.lost_s_at_most = kLongestUnwrittenS + kLongestUnsynchronisedS + (std::isfinite(lost_s) ? lost_s : 0.0);
  return ending;
}

class Copier {
 public:
  Copier(const Survey& found, const std::string& index) : found_(found), index_(index) {}

  core::Status copy_chunks(ChunkStream& stream, const std::string& copy, const Progress& progress);
  core::Status close(const Ending& ending);
  void discard() noexcept {
    if (file_) file_->discard();
  }
  [[nodiscard]] const DurableFile& file() const noexcept { return *file_; }

 private:
  core::Status copy_chunk(const RawChunk& raw, const std::string& copy);
  [[nodiscard]] ChunkNote note_of(const RawChunk& raw, const Chunk& chunk);
  [[nodiscard]] ChunkNote continued_note(const Samples& samples) const;
  [[nodiscard]] bool is_left_out(const Chunk& chunk) const;

  const Survey& found_;
  IndexReader index_;
  ChunkDecoder decoder_;
  std::unique_ptr<DurableFile> file_;
  std::map<std::uint32_t, ChunkNote> last_notes_;
  std::map<std::uint32_t, std::vector<std::pair<double, double>>> offsets_;
};

/// Returns true for chunks that are not copied: footers, which `close` writes again, and streams without samples, on which libxdf crashes.
bool Copier::is_left_out(const Chunk& chunk) const {
  const auto is_empty = [this](std::uint32_t number) {
    const auto stream = found_.streams.find(number);
    return stream == found_.streams.end() || (stream->second.scan_s > 0.0 && stream->second.samples == 0);
  };
  if (std::holds_alternative<StreamFooter>(chunk.content)) return true;
  if (const auto* header = std::get_if<StreamHeader>(&chunk.content)) return is_empty(header->stream);
  if (const auto* offset = std::get_if<ClockOffset>(&chunk.content)) return is_empty(offset->stream);
  if (const auto* samples = std::get_if<Samples>(&chunk.content)) return is_empty(samples->stream);
  return false;
}

/// Returns a note for a chunk that is not in the index: its scans continue those of the stream's previous chunk.
ChunkNote Copier::continued_note(const Samples& samples) const {
  ChunkNote note{.stream = samples.stream, .samples = samples.times_s.size()};
  if (!samples.times_s.empty()) note.time_s = samples.times_s.front();
  const auto last = last_notes_.find(samples.stream);
  if (last == last_notes_.end()) return note;
  note.segment = last->second.segment;
  note.first_scan = last->second.first_scan + last->second.samples;
  return note;
}

ChunkNote Copier::note_of(const RawChunk& raw, const Chunk& chunk) {
  const auto indexed = index_.next();
  const auto* samples = std::get_if<Samples>(&chunk.content);
  if (samples == nullptr) return {};
  const bool is_this =
      indexed && indexed->offset == raw.offset && indexed->length == raw.bytes.size() && indexed->stream == samples->stream;
  const ChunkNote note = is_this ? *indexed : continued_note(*samples);
  last_notes_[samples->stream] = note;
  return note;
}

core::Status Copier::copy_chunk(const RawChunk& raw, const std::string& copy) {
  DTS_TRY_ASSIGN(const auto chunk, decoder_.decode(raw));
  NotedChunk noted{.bytes = std::string(raw.bytes), .note = note_of(raw, chunk)};
  if (!file_) {
    DTS_TRY_ASSIGN(file_, DurableFile::create(copy, std::move(noted)));
    return {};
  }
  if (is_left_out(chunk)) return {};
  if (const auto* offset = std::get_if<ClockOffset>(&chunk.content)) {
    auto& offsets = offsets_[offset->stream];
    if (offsets.size() < kMaxFooterOffsets) offsets.emplace_back(offset->stream_time_s, offset->offset_s);
  }
  return file_->append({&noted, 1});
}

core::Status Copier::copy_chunks(ChunkStream& stream, const std::string& copy, const Progress& progress) {
  ProgressMeter meter(progress, found_.end);
  while (stream.offset() < found_.end) {
    DTS_TRY_ASSIGN(const auto raw, stream.next());
    if (!raw) return core::fail(core::ErrorCode::Failed, "the file was cut while it was copied");
    DTS_TRY(copy_chunk(*raw, copy));
    DTS_TRY(meter.advance(stream.offset()));
  }
  return {};
}

core::Status Copier::close(const Ending& ending) {
  std::vector<NotedChunk> footers;
  for (const auto& [number, stream] : found_.streams) {
    if (stream.scan_s > 0.0 && stream.samples == 0) continue;
    StreamSummary summary{.first_time_s = stream.first_time_s, .last_time_s = stream.last_time_s, .sample_count = stream.samples};
    summary.clock_offsets = offsets_[number];
    summary.facts = {{"recovered", "yes"}, {"lost_s_at_most", shortest_text(ending.lost_s_at_most)}};
    if (!ending.incomplete.empty()) summary.facts.emplace_back("incomplete", ending.incomplete);
    std::string content;
    put(content, number);
    footers.push_back({.bytes = make_chunk(ChunkTag::StreamFooter, content.append(stream_footer_xml(summary)))});
  }
  DTS_TRY(file_->append(footers));
  return file_->publish();
}

/// Removes the files of an interrupted recovery. This is safe: no recording has such a name.
void remove_leftovers(const std::string& copy) {
  struct stat there {};
  if (!copy.ends_with(kRecovered) || ::lstat(copy.c_str(), &there) == 0) return;
  ::unlink((copy + std::string(kPart)).c_str());
  ::unlink(index_name(copy).c_str());
}

core::Status check_recoverable(const std::string& file, const Survey& found) {
  if (!found.has_file_header) {
    const core::Error why = found.fault.value_or(core::Error{core::ErrorCode::DataDamaged, "it ends before its file header", {}});
    return core::fail(why.code, file + " cannot be recovered: " + why.what, why.hint);
  }
  if (!found.is_closed() || file.ends_with(kPart)) return {};
  return core::fail(core::ErrorCode::WrongState, file + " is complete and closed", "there is nothing to recover");
}

}  // namespace

std::string recovered_name(const std::string& file) {
  std::string_view stem = file;
  if (stem.ends_with(kPart)) stem.remove_suffix(kPart.size());
  if (stem.ends_with(kRecording)) stem.remove_suffix(kRecording.size());
  return std::string(stem) + std::string(kRecovered);
}

core::Result<Recovery> recover(const std::string& file, const std::string& copy, const Progress& progress) {
  // Two passes, each half of the work: only the first pass finds which chunks to keep.
  const auto first_half = [&progress](std::uint64_t done, std::uint64_t of) { return !progress || progress(done, 2 * of); };
  const auto second_half = [&progress](std::uint64_t done, std::uint64_t of) { return !progress || progress(of + done, 2 * of); };
  DTS_TRY_ASSIGN(const auto found, survey(file, first_half));
  DTS_TRY(check_recoverable(file, found));
  DTS_TRY_ASSIGN(auto stream, ChunkStream::open(file));
  remove_leftovers(copy);
  Copier copier(found, index_name(file));
  const Ending ending = ending_of(found);
  auto status = copier.copy_chunks(*stream, copy, second_half);
  if (status) status = copier.close(ending);
  if (!status) {
    copier.discard();
    return tl::make_unexpected(status.error());
  }
  return Recovery{.file = copy,
                  .sha256 = copier.file().sha256(),
                  .kept_bytes = found.end,
                  .dropped_bytes = found.size - found.end,
                  .chunks = found.chunks,
                  .duration_s = found.duration_s(),
                  .lost_s_at_most = ending.lost_s_at_most,
                  .reason = ending.reason};
}

}  // namespace dts::record
