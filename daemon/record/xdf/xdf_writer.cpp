// SPDX-License-Identifier: Apache-2.0
#include "record/xdf/xdf_writer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "record/xdf/byte_codec.h"
#include "record/xdf/durable_file.h"
#include "record/xdf/header_xml.h"
#include "record/xdf/samples_codec.h"

namespace dts::record {
namespace {

constexpr auto kWrong = core::ErrorCode::InvalidArgument;

std::string with_stream(std::uint32_t stream, const std::string& xml) {
  std::string content;
  put(content, stream);
  return content.append(xml);
}

core::Status check_times(std::span<const double> times_s) {
  if (std::ranges::all_of(times_s, [](double time_s) { return std::isfinite(time_s); })) return {};
  return core::fail(kWrong, "a time stamp is not a finite number");
}

}  // namespace

class XdfWriter::Implementation {
 public:
  struct Stream {
    StreamInfo info;
    bool is_written = false;
    StreamSummary summary{};                                     ///< Without its clock offsets.
    std::vector<std::pair<std::size_t, std::size_t>> offsets{};  ///< Ranges of `offsets_`.
  };

  Implementation(std::unique_ptr<DurableFile> file, std::string session_id) : file_(std::move(file)), session_id_(std::move(session_id)) {}

  std::uint32_t add(StreamInfo info) {
    streams_.push_back({.info = std::move(info)});
    return static_cast<std::uint32_t>(streams_.size());
  }
  Stream* find(std::uint32_t stream) noexcept { return stream >= 1 && stream <= streams_.size() ? &streams_[stream - 1] : nullptr; }

  core::Result<Stream*> usable(std::uint32_t number, bool is_text);
  core::Status write_samples(std::uint32_t number, const std::string& content, std::size_t count, double first_s, double last_s,
                             Position position);
  core::Status write_clock_offset(std::uint32_t number, double stream_time_s, double offset_s);
  core::Status write_chunk(std::string chunk);
  core::Status synchronise();
  core::Result<Closed> close(const std::string& incomplete);
  void abandon() noexcept {
    file_->close_descriptors();
    fail_with({core::ErrorCode::WrongState, "the recording is closed", {}});
    is_over_ = true;
  }
  [[nodiscard]] const DurableFile& file() const noexcept { return *file_; }

 private:
  core::Status keep_error(core::Status status);
  void fail_with(core::Error error) {
    if (!error_) error_ = std::move(error);
  }
  void keep_offset(Stream& stream, std::pair<double, double> offset);
  NotedChunk header_of(Stream& stream, std::uint32_t number, double created_at_s) const;
  core::Status write_footers(const std::string& incomplete);

  std::unique_ptr<DurableFile> file_;
  std::string session_id_;
  std::vector<Stream> streams_;
  /// For the footers: (time, offset). One clock gives all streams the same ones, and a session of a day has 17,000: they are kept once.
  /// `kMaxFooterOffsets` limits all of them together.
  std::vector<std::pair<double, double>> offsets_;
  std::optional<core::Error> error_;
  std::optional<DurableFile::Mark> before_footers_;
  bool is_over_ = false;
};

core::Status XdfWriter::Implementation::keep_error(core::Status status) {
  if (!status) fail_with(status.error());
  return status;
}

/// Returns the stream if samples can be written to it now. A wrong call does not break the writer.
core::Result<XdfWriter::Implementation::Stream*> XdfWriter::Implementation::usable(std::uint32_t number, bool is_text) {
  if (error_) return tl::make_unexpected(*error_);
  Stream* stream = find(number);
  if (stream == nullptr) return core::fail(kWrong, "stream " + std::to_string(number) + " was not added");
  if ((stream->info.value_type == ValueType::Text) != is_text)
    return core::fail(kWrong, "stream " + stream->info.name + " does not hold " + (is_text ? "texts" : "numbers"));
  const std::size_t channels = stream->info.channels.size();
  if (channels < 1 || channels > kMaxChannels || (is_text && channels != 1))
    return core::fail(kWrong, "stream " + stream->info.name + " has " + std::to_string(channels) + " channels");
  return stream;
}

NotedChunk XdfWriter::Implementation::header_of(Stream& stream, std::uint32_t number, double created_at_s) const {
  const StreamOrigin origin{.session_id = session_id_, .stream = number, .created_at_s = created_at_s};
  return {.bytes = make_chunk(ChunkTag::StreamHeader, with_stream(number, stream_header_xml(stream.info, origin)))};
}

/// Writes samples. Writes a stream's header and its first samples with one write: a crash between two writes would leave a header without
/// samples, on which libxdf crashes.
core::Status XdfWriter::Implementation::write_samples(std::uint32_t number, const std::string& content, std::size_t count, double first_s,
                                                      double last_s, Position position) {
  Stream& stream = *find(number);
  NotedChunk samples{.bytes = make_chunk(ChunkTag::Samples, content)};
  samples.note = {
      .stream = number, .segment = position.segment, .first_scan = position.first_scan.value, .samples = count, .time_s = first_s};
  std::vector<NotedChunk> chunks;
  if (!stream.is_written) chunks.push_back(header_of(stream, number, first_s));
  chunks.push_back(std::move(samples));
  if (chunks.back().bytes.size() > kMaxChunkBytes || (chunks.size() > 1 && chunks.front().bytes.size() > kMaxXmlBytes))
    return core::fail(core::ErrorCode::LimitExceeded, "too long for one chunk of stream " + stream.info.name);
  const std::uint64_t bytes_before = file_->bytes();
  auto status = keep_error(file_->append(chunks));
  if (file_->bytes() == bytes_before) return status;
  if (stream.summary.sample_count == 0)
    stream.summary.first_time_s = first_s;  // the samples are in the file, even if writing the index failed
  stream.is_written = true;
  stream.summary.last_time_s = last_s;
  stream.summary.sample_count += count;
  return status;
}

core::Status XdfWriter::Implementation::write_clock_offset(std::uint32_t number, double stream_time_s, double offset_s) {
  if (error_) return tl::make_unexpected(*error_);
  Stream* stream = find(number);
  if (stream == nullptr || !stream->is_written)
    return core::fail(core::ErrorCode::WrongState, "stream " + std::to_string(number) + " has no samples yet");
  if (!std::isfinite(stream_time_s) || !std::isfinite(offset_s)) return core::fail(kWrong, "a clock offset is not a finite number");
  std::string content;
  put(content, number);
  put(content, stream_time_s);
  put(content, offset_s);
  auto status = write_chunk(make_chunk(ChunkTag::ClockOffset, content));
  if (status) keep_offset(*stream, {stream_time_s, offset_s});
  return status;
}

void XdfWriter::Implementation::keep_offset(Stream& stream, std::pair<double, double> offset) {
  if (offsets_.empty() || offsets_.back() != offset) {
    if (offsets_.size() == kMaxFooterOffsets) return;
    offsets_.push_back(offset);
  }
  const std::size_t index = offsets_.size() - 1;
  if (stream.offsets.empty() || stream.offsets.back().second != index) stream.offsets.emplace_back(index, index);
  ++stream.offsets.back().second;
}

core::Status XdfWriter::Implementation::write_chunk(std::string chunk) {
  if (error_) return tl::make_unexpected(*error_);
  NotedChunk noted{.bytes = std::move(chunk)};
  return keep_error(file_->append({&noted, 1}));
}

core::Status XdfWriter::Implementation::synchronise() {
  if (error_) return tl::make_unexpected(*error_);
  return keep_error(file_->synchronise());
}

/// Writes all footers or none: a reader that finds one footer may think that the file is closed.
core::Status XdfWriter::Implementation::write_footers(const std::string& incomplete) {
  // Also cuts off a torn chunk of an earlier error, or the footers of an earlier attempt.
  if (!before_footers_) before_footers_ = file_->mark();
  DTS_TRY(file_->cut_back(*before_footers_));
  std::vector<NotedChunk> footers;
  for (std::uint32_t number = 1; number <= streams_.size(); ++number) {
    const Stream& stream = *find(number);
    if (!stream.is_written) continue;
    StreamSummary summary = stream.summary;
    for (const auto& [first, end] : stream.offsets) {
      for (std::size_t index = first; index < end; ++index) summary.clock_offsets.push_back(offsets_[index]);
    }
    if (!incomplete.empty()) summary.facts.emplace_back("incomplete", incomplete);
    footers.push_back({.bytes = make_chunk(ChunkTag::StreamFooter, with_stream(number, stream_footer_xml(summary)))});
  }
  auto status = file_->append(footers);
  if (!status) [[maybe_unused]]
    const auto ignored = file_->cut_back(*before_footers_);
  return status;
}

core::Result<XdfWriter::Closed> XdfWriter::Implementation::close(const std::string& incomplete) {
  if (is_over_) return core::fail(core::ErrorCode::WrongState, "the recording is closed");
  if (error_ && incomplete.empty()) return tl::make_unexpected(*error_);
  DTS_TRY(keep_error(write_footers(incomplete)));
  DTS_TRY(keep_error(file_->publish()));
  abandon();
  return Closed{.file = file_->name(), .sha256 = file_->sha256(), .bytes = file_->bytes()};
}

core::Result<std::unique_ptr<XdfWriter>> XdfWriter::create(const std::string& name,
                                                           const std::vector<std::pair<std::string, std::string>>& facts) {
  const std::string xml = file_header_xml(facts);
  if (xml.size() > kMaxXmlBytes) return core::fail(core::ErrorCode::LimitExceeded, "the facts of a recording are longer than 8 MiB");
  DTS_TRY_ASSIGN(auto file, DurableFile::create(name, {.bytes = make_chunk(ChunkTag::FileHeader, xml)}));
  return std::unique_ptr<XdfWriter>(new XdfWriter(std::make_unique<Implementation>(std::move(file), fact(facts, "session_id"))));
}

XdfWriter::XdfWriter(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}
XdfWriter::~XdfWriter() = default;

std::uint32_t XdfWriter::add_stream(StreamInfo info) { return implementation_->add(std::move(info)); }

void XdfWriter::add_fact(std::uint32_t stream, const std::string& name, const std::string& value) {
  if (auto* found = implementation_->find(stream); found != nullptr) found->info.facts.emplace_back(name, value);
}

core::Status XdfWriter::write_samples(std::uint32_t stream, double first_time_s, std::span<const double> values, Position position) {
  DTS_TRY_ASSIGN(const auto found, implementation_->usable(stream, false));
  const auto& info = found->info;
  const std::size_t count = values.size() / info.channels.size();
  if (!info.rate || count * info.channels.size() != values.size())
    return core::fail(kWrong, "stream " + info.name + (info.rate ? ": half a scan" : " is irregular: every sample needs its time"));
  const std::array<double, 1> times_s = {first_time_s};
  if (auto status = check_times(times_s); !status || count == 0) return status;
  TimeGrid grid{.rate = info.rate, .given_s = first_time_s, .since_given = count - 2};
  const double last_s = count > 1 ? grid.next() : first_time_s;
  return implementation_->write_samples(stream, encode_samples(stream, info.value_type, info.channels.size(), times_s, values), count,
                                        first_time_s, last_s, position);
}

core::Status XdfWriter::write_timed(std::uint32_t stream, std::span<const double> times_s, std::span<const double> values,
                                    Position position) {
  DTS_TRY_ASSIGN(const auto found, implementation_->usable(stream, false));
  const auto& info = found->info;
  if (times_s.size() * info.channels.size() != values.size())
    return core::fail(
        kWrong, "stream " + info.name + ": " + std::to_string(times_s.size()) + " times, " + std::to_string(values.size()) + " values");
  if (auto status = check_times(times_s); !status || times_s.empty()) return status;
  return implementation_->write_samples(stream, encode_samples(stream, info.value_type, info.channels.size(), times_s, values),
                                        times_s.size(), times_s.front(), times_s.back(), position);
}

core::Status XdfWriter::write_texts(std::uint32_t stream, std::span<const std::pair<double, std::string>> texts, Position position) {
  DTS_TRY(implementation_->usable(stream, true));
  for (const auto& [time_s, text] : texts) DTS_TRY(check_times({&time_s, 1}));
  if (texts.empty()) return {};
  return implementation_->write_samples(stream, encode_texts(stream, texts), texts.size(), texts.front().first, texts.back().first,
                                        position);
}

core::Status XdfWriter::write_clock_offset(std::uint32_t stream, double stream_time_s, double offset_s) {
  return implementation_->write_clock_offset(stream, stream_time_s, offset_s);
}

core::Status XdfWriter::write_boundary() { return implementation_->write_chunk(make_chunk(ChunkTag::Boundary, kBoundaryMark)); }
core::Status XdfWriter::synchronise() { return implementation_->synchronise(); }
core::Result<XdfWriter::Closed> XdfWriter::close() { return implementation_->close({}); }
core::Result<XdfWriter::Closed> XdfWriter::close_incomplete(const std::string& reason) {
  return implementation_->close(reason.empty() ? "unknown reason" : reason);
}
void XdfWriter::abandon() noexcept { implementation_->abandon(); }
std::uint64_t XdfWriter::bytes() const noexcept { return implementation_->file().bytes(); }
std::uint64_t XdfWriter::sample_count(std::uint32_t stream) const noexcept {
  const auto* found = implementation_->find(stream);
  return found != nullptr ? found->summary.sample_count : 0;
}

}  // namespace dts::record
