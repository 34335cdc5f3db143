// SPDX-License-Identifier: Apache-2.0
#include "record/recording.h"

#include <algorithm>
#include <variant>

#include "dts/wire/event_json.h"
#include "record/old_event.h"
#include "record/overview.h"
#include "record/utf8_text.h"
#include "record/xdf/xdf_reader.h"

namespace dts::record {
namespace {

class FileRecording : public Recording {
 public:
  FileRecording(std::string file, Overview overview) : file_(std::move(file)), overview_(std::move(overview)) {}

  [[nodiscard]] const std::vector<StreamInfo>& streams() const noexcept override { return overview_.streams; }
  [[nodiscard]] std::optional<std::size_t> find_stream(const std::string& name) const override;
  [[nodiscard]] const std::optional<SessionFacts>& session() const noexcept override { return overview_.session; }
  [[nodiscard]] const std::string& damage() const noexcept override { return overview_.damage; }
  [[nodiscard]] const core::Losses& losses() const noexcept override { return overview_.losses; }
  [[nodiscard]] double duration_s() const noexcept override { return overview_.duration_s; }
  [[nodiscard]] std::uint64_t sample_count(std::size_t stream) const override {
    return stream < overview_.sample_counts.size() ? overview_.sample_counts[stream] : 0;
  }

  [[nodiscard]] core::Result<std::optional<RecordedItem>> next() override;
  core::Status rewind() override;
  [[nodiscard]] std::uint64_t offset() const noexcept override { return reader_ ? reader_->offset() : 0; }
  [[nodiscard]] std::uint64_t size() const noexcept override { return overview_.end; }

 private:
  std::optional<RecordedItem> start_chunk(Chunk& chunk);
  RecordedItem next_of_samples();
  RecordedScans next_scans(const StreamInfo& info);
  TimedEvent next_event(std::size_t channels);
  [[nodiscard]] SegmentTable::Place reference_place(double time_s) const noexcept;

  std::string file_;
  Overview overview_;
  std::unique_ptr<XdfReader> reader_;
  std::vector<std::optional<GridTracker>> grids_;  ///< By stream; used if no event defines segments.
  Samples samples_;                                ///< Samples of the current chunk.
  std::size_t stream_ = 0;                         ///< Stream of the current chunk.
  std::size_t taken_ = 0;                          ///< Number of its samples (or texts) returned so far.
};

std::optional<std::size_t> FileRecording::find_stream(const std::string& name) const {
  const auto& streams = overview_.streams;
  const auto exact = std::ranges::find(streams, name, &StreamInfo::name);
  const auto found = exact != streams.end()
                         ? exact
                         : std::ranges::find_if(streams, [&name](const StreamInfo& info) { return short_name(info.name) == name; });
  if (found == streams.end()) return std::nullopt;
  return static_cast<std::size_t>(found - streams.begin());
}

core::Status FileRecording::rewind() {
  DTS_TRY_ASSIGN(reader_, XdfReader::open(file_));
  samples_ = {};
  taken_ = 0;
  grids_.clear();
  for (const auto& info : overview_.streams) {
    const bool is_regular = info.rate && info.value_type != ValueType::Text;
    grids_.push_back(is_regular ? std::optional<GridTracker>(GridTracker(*info.rate)) : std::nullopt);
  }
  return {};
}

core::Result<std::optional<RecordedItem>> FileRecording::next() {
  while (true) {
    if (taken_ < std::max(samples_.texts.size(), samples_.times_s.size())) return std::optional(next_of_samples());
    if (reader_->offset() >= overview_.end) return std::optional<RecordedItem>();  // the rest is torn, or was written after `open`
    DTS_TRY_ASSIGN(auto chunk, reader_->next());
    if (!chunk) return std::optional<RecordedItem>();
    if (auto item = start_chunk(*chunk)) return item;
  }
}

/// Returns an item if the whole chunk is one item; stores samples for `next_of_samples`.
std::optional<RecordedItem> FileRecording::start_chunk(Chunk& chunk) {
  if (const auto* offset = std::get_if<ClockOffset>(&chunk.content)) {
    const auto stream = overview_.index_of_number.find(offset->stream);
    if (stream == overview_.index_of_number.end()) return std::nullopt;
    return RecordedOffset{.time_s = offset->stream_time_s, .offset_s = offset->offset_s, .stream = stream->second};
  }
  auto* samples = std::get_if<Samples>(&chunk.content);
  if (samples == nullptr) return std::nullopt;
  const auto stream = overview_.index_of_number.find(samples->stream);
  if (stream == overview_.index_of_number.end()) return std::nullopt;
  const std::size_t values = samples->times_s.size() * overview_.streams[stream->second].channels.size();
  if (samples->values.size() + samples->texts.size() != values) return std::nullopt;  // the file was replaced after `open`
  samples_ = std::move(*samples);
  stream_ = stream->second;
  taken_ = 0;
  return std::nullopt;
}

SegmentTable::Place FileRecording::reference_place(double time_s) const noexcept {
  if (!overview_.reference_rate) return {};
  return overview_.segments.place_of(time_s, *overview_.reference_rate, *overview_.reference_rate);
}

RecordedItem FileRecording::next_of_samples() {
  const StreamInfo& info = overview_.streams[stream_];
  if (info.value_type == ValueType::Text) return next_event(info.channels.size());
  if (info.rate) return next_scans(info);
  const double time_s = samples_.times_s[taken_];
  const auto place = reference_place(time_s);
  const auto first = samples_.values.begin() + static_cast<std::ptrdiff_t>(taken_ * info.channels.size());
  ++taken_;
  return RecordedChange{.stream = stream_,
                        .segment = place.segment,
                        .scan = place.scan,
                        .time_s = time_s,
                        .values = {first, first + static_cast<std::ptrdiff_t>(info.channels.size())}};
}

/// Returns the next scans, up to the next gap.
RecordedScans FileRecording::next_scans(const StreamInfo& info) {
  GridTracker& grid = *grids_[stream_];
  const std::size_t begin = taken_;
  const auto& times_s = samples_.times_s;
  RecordedScans scans{.stream = stream_, .first_time_s = times_s[begin]};
  grid.add(times_s[begin]);
  const core::Rate reference = overview_.reference_rate.value_or(*info.rate);
  const auto place = overview_.has_segment_events ? overview_.segments.place_of(times_s[begin], *info.rate, reference) : grid.place();
  scans.segment = place.segment;
  scans.first_scan = place.scan;
  for (taken_ = begin + 1; taken_ < times_s.size() && grid.continues(times_s[taken_ - 1], times_s[taken_]); ++taken_)
    grid.add(times_s[taken_]);
  scans.count = taken_ - begin;
  if (scans.count == times_s.size()) {
    scans.values = std::move(samples_.values);
    return scans;
  }
  const auto channels = info.channels.size();
  const auto first = samples_.values.begin();
  scans.values.assign(first + static_cast<std::ptrdiff_t>(begin * channels), first + static_cast<std::ptrdiff_t>(taken_ * channels));
  return scans;
}

TimedEvent FileRecording::next_event(std::size_t channels) {
  const std::string& text = samples_.texts[taken_];
  const double time_s = samples_.times_s[taken_ / channels];
  ++taken_;
  if (auto event = wire::event_of_json(text)) return {.time_s = time_s, .event = std::move(*event)};
  if (auto event = old_event_of(text)) return {.time_s = time_s, .event = std::move(*event), .old_text = text};
  const auto place = reference_place(time_s);
  v1::Event marker;
  marker.set_segment(place.segment);
  marker.set_scan(place.scan.value);
  marker.mutable_marker()->set_text(clean_text(text));
  return {.time_s = time_s, .event = std::move(marker)};
}

}  // namespace

core::Result<std::unique_ptr<Recording>> Recording::open(const std::string& file) {
  DTS_TRY_ASSIGN(auto overview, look_through(file));
  auto recording = std::make_unique<FileRecording>(file, std::move(overview));
  DTS_TRY(recording->rewind());
  return recording;
}

core::Result<SessionFacts> read_session_facts(const std::string& file) {
  DTS_TRY_ASSIGN(const auto reader, XdfReader::open(file));
  DTS_TRY_ASSIGN(const auto chunk, reader->next());
  const auto* header = chunk ? std::get_if<FileHeader>(&chunk->content) : nullptr;
  if (header == nullptr) return core::fail(core::ErrorCode::DataDamaged, "it has no file header");
  if (fact(header->facts, "session_id").empty()) return core::fail(core::ErrorCode::Unsupported, "it is not a recording of dtsd");
  return session_facts(header->facts);
}

}  // namespace dts::record
