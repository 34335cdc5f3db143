// SPDX-License-Identifier: Apache-2.0
#include "record/recorder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <variant>

#include "dts/wire/event_json.h"
#include "events/make.h"
#include "record/xdf/recovery.h"

namespace dts::record {
namespace {

constexpr double kChunkMs = 0.8 * 1000.0 * kLongestUnwrittenS;  // leaves 20 % of the time for the way from the pipeline
constexpr std::int64_t kOffsetEveryNs = 5'000'000'000;
constexpr std::int64_t kBoundaryEveryNs = 2'000'000'000;
constexpr std::int64_t kRoundingNs = 2;  // rounding error of two conversions, not clock drift
constexpr std::size_t kMostWaitingEvents = 10'000;

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }

std::string numbers_text(std::span<const double> values) {
  std::string text;
  std::array<char, 32> digits{};
  for (const double value : values) {
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    if (!text.empty()) text += ' ';
    text.append(digits.data(), end);
  }
  return text;
}

StreamInfo quality_info(const std::string& rig, const std::vector<RecordedStream>& streams) {
  StreamInfo info{.name = rig + "/quality", .content = "Quality", .value_type = ValueType::Int8, .rate = {}, .channels = {}};
  for (const RecordedStream& stream : streams) {
    const std::string name = short_name(stream.info.name);
    if (name != "raw" && name != "aux") continue;
    for (const ChannelInfo& channel : stream.info.channels)
      info.channels.push_back({.label = channel.label, .unit = {}, .type = "Quality"});
  }
  return info;
}

StreamInfo events_info(const std::string& rig) {
  return {.name = rig + "/events",
          .content = "Markers",
          .value_type = ValueType::Text,
          .rate = {},
          .channels = {{.label = "event", .unit = {}, .type = "Marker"}}};
}

}  // namespace

core::Result<std::unique_ptr<Recorder>> Recorder::create(const std::string& file, const SessionFacts& facts,
                                                         std::vector<RecordedStream> streams) {
  if (streams.empty() || short_name(streams.front().info.name) != "raw" || !streams.front().info.rate) {
    return core::fail(core::ErrorCode::InvalidArgument, "recording " + file + ": its first stream is not \"raw\"");
  }
  if (!std::ranges::all_of(streams, [](const RecordedStream& stream) { return stream.info.rate.has_value(); })) {
    return core::fail(core::ErrorCode::InvalidArgument, "recording " + file + ": one of its streams has no rate");
  }
  DTS_TRY_ASSIGN(auto writer, XdfWriter::create(file, to_facts(facts)));
  std::unique_ptr<Recorder> recorder(new Recorder(std::move(writer)));
  recorder->rate_ = *streams.front().info.rate;
  recorder->created_at_s_ = seconds(facts.started_utc_ns - facts.utc_minus_monotonic_ns);
  recorder->events_number_ = recorder->writer_->add_stream(events_info(facts.rig));
  StreamInfo quality = quality_info(facts.rig, streams);
  recorder->last_quality_.resize(quality.channels.size());
  recorder->quality_number_ = recorder->writer_->add_stream(std::move(quality));
  for (RecordedStream& stream : streams) {
    const std::string name = short_name(stream.info.name);
    if (name == "raw" || name == "aux") recorder->quality_sources_.push_back(stream.frame_index);
    const std::size_t chunk_scans = stream.info.rate ? stream.info.rate->scans_in_ms(kChunkMs) : 1;
    const std::uint32_t number = recorder->writer_->add_stream(stream.info);
    recorder->columns_.push_back({.recorded = std::move(stream), .number = number, .chunk_scans = chunk_scans});
    recorder->columns_.back().pending.reserve(chunk_scans * recorder->columns_.back().recorded.info.channels.size());
  }
  return recorder;
}

void Recorder::set_stage_state(std::span<const double> state) {
  writer_->add_fact(columns_.front().number, "stage_state", numbers_text(state));
}

std::optional<double> Recorder::time_s(std::uint32_t segment, core::ScanIndex scan) const noexcept {
  const auto origin = origins_ns_.find(segment);
  if (origin == origins_ns_.end()) return std::nullopt;
  return seconds(origin->second + rate_.time_ns(scan));
}

core::Status Recorder::take(const core::Frame& frame, std::span<const core::Event> events) {
  if (frame.gap_before.reason != core::GapReason::None) gap_ = frame.gap_before;
  const core::Block& raw = frame.streams[columns_.front().recorded.frame_index];
  if (raw.count() == 0) return {};
  if (!origins_ns_.contains(raw.segment)) {
    DTS_TRY(begin_segment(frame));
  } else {
    note_jump(raw);
  }
  offset_ns_ = raw.host_time_ns - (origins_ns_[segment_] + rate_.time_ns(raw.first_scan));
  if (std::abs(offset_ns_) <= kRoundingNs) offset_ns_ = 0;
  write_quality(frame);
  for (const core::Event& event : events) {
    if (!std::holds_alternative<core::SwayEvent>(event)) keep(events::make(event, {}));  // preliminary values are not recorded
  }
  next_raw_ = raw.first_scan + raw.count();
  for (Column& column : columns_) {
    DTS_TRY(write_block(column, frame.streams[column.recorded.frame_index], raw));
  }
  return write_offsets(raw);
}

/// Writes the rest of the previous segment first, then the event with the start of the new segment. Readers need this event to place the
/// samples that follow.
core::Status Recorder::begin_segment(const core::Frame& frame) {
  DTS_TRY(flush());
  const core::Block& raw = frame.streams[columns_.front().recorded.frame_index];
  segment_ = raw.segment;
  origins_ns_[segment_] = raw.host_time_ns - offset_ns_ - rate_.time_ns(raw.first_scan);
  for (Column& column : columns_) column.has_origin = false;
  is_quality_due_ = true;
  v1::Event event;
  event.set_segment(segment_);
  event.set_scan(raw.first_scan.value);
  event.set_host_time_ns(raw.host_time_ns);
  v1::SegmentStart& start = *event.mutable_segment_start();
  start.set_reason(static_cast<v1::GapReason>(gap_.reason));
  start.set_missing_scans(gap_.missing_scans);
  start.set_is_exact(gap_.is_exact);
  losses_.add(event);
  gap_ = {};
  next_raw_ = raw.first_scan;
  DTS_TRY(take(event));
  for (v1::Event& waiting : std::exchange(waiting_events_, {})) {
    if (waiting.segment() < segment_) {  // its segment was never recorded
      waiting.set_segment(segment_);
      waiting.set_scan(raw.first_scan.value);
    }
    DTS_TRY(take(waiting));
  }
  return write_events();
}

void Recorder::note_jump(const core::Block& raw) {
  if (raw.segment != segment_ || raw.first_scan == next_raw_) return;
  const std::uint64_t lost = raw.first_scan.value > next_raw_.value ? raw.first_scan.value - next_raw_.value : 0;
  next_raw_ = raw.first_scan;
  note_loss(lost);
}

void Recorder::note_loss(std::uint64_t scans) {
  lost_scans_ += scans;
  v1::Event event;
  event.set_segment(segment_);
  event.set_scan(next_raw_.value);
  event.mutable_loss()->set_scans(scans);
  losses_.add(event);
  keep(event);
  is_quality_due_ = true;
}

core::Status Recorder::write_block(Column& column, const core::Block& block, const core::Block& raw) {
  if (block.count() == 0) return {};
  const core::Rate& rate = *column.recorded.info.rate;
  if (!column.has_origin) {  // from the same frame as the raw stream's origin, so that all streams of a segment have one time axis
    const std::int64_t raw_zero_ns = raw.host_time_ns - rate_.time_ns(raw.first_scan);
    column.origin_ns = origins_ns_[segment_] + (block.host_time_ns - rate.time_ns(block.first_scan) - raw_zero_ns);
    column.has_origin = true;
  }
  if (!column.pending.empty() && block.first_scan != column.next) {
    DTS_TRY(write_pending(column));
  }
  const std::size_t channels = std::min(block.channel_count(), column.recorded.info.channels.size());
  for (std::size_t scan = 0; scan < block.count(); ++scan) {
    if (column.pending.empty()) column.first_pending = block.first_scan + scan;
    for (std::size_t channel = 0; channel < channels; ++channel) column.pending.push_back(block.column(channel)[scan]);
    column.next = block.first_scan + (scan + 1);
    if (column.pending.size() < column.chunk_scans * channels) continue;
    DTS_TRY(write_pending(column));
  }
  return {};
}

void Recorder::write_quality(const core::Frame& frame) {
  const core::Block& raw = frame.streams[columns_.front().recorded.frame_index];
  for (std::size_t scan = 0; scan < raw.count(); ++scan) {
    bool has_changed = std::exchange(is_quality_due_, false);
    std::size_t bits = 0;
    for (const std::size_t source : quality_sources_) {
      const core::Block& block = frame.streams[source];
      for (std::size_t channel = 0; channel < block.channel_count() && bits < last_quality_.size(); ++channel, ++bits) {
        const std::uint8_t quality = scan < block.count() ? block.quality(channel)[scan] : std::uint8_t{0};
        has_changed = has_changed || quality != last_quality_[bits];
        last_quality_[bits] = quality;
      }
    }
    if (!has_changed) continue;
    quality_times_s_.push_back(time_s(segment_, raw.first_scan + scan).value_or(0.0));
    quality_values_.insert(quality_values_.end(), last_quality_.begin(), last_quality_.end());
  }
}

void Recorder::keep(const v1::Event& event) {
  if (const auto at_s = time_s(event.segment(), {event.scan()})) events_.emplace_back(*at_s, wire::to_json(event));
}

core::Status Recorder::take(const v1::Event& event) {
  if (const auto at_s = time_s(event.segment(), {event.scan()})) {
    events_.emplace_back(*at_s, wire::to_json(event));
  } else if (waiting_events_.size() < kMostWaitingEvents) {
    waiting_events_.push_back(event);
  }
  return {};
}

core::Status Recorder::write_pending(Column& column) {
  if (column.pending.empty()) return {};
  const double first_s = seconds(column.origin_ns + column.recorded.info.rate->time_ns(column.first_pending));
  auto written = writer_->write_samples(column.number, first_s, column.pending, {.segment = segment_, .first_scan = column.first_pending});
  column.pending.clear();
  if (!written || &column != &columns_.front()) return written;
  if (end_s_ == 0.0) begin_s_ = first_s;
  end_s_ = seconds(column.origin_ns + rate_.time_ns(column.next));
  DTS_TRY(write_events());
  return write_quality();
}

core::Status Recorder::write_events() {
  if (events_.empty()) return {};
  std::ranges::stable_sort(events_, {}, &std::pair<double, std::string>::first);
  auto written = writer_->write_texts(events_number_, events_, position());
  events_.clear();
  return written;
}

core::Status Recorder::write_quality() {
  if (quality_times_s_.empty()) return {};
  auto written = writer_->write_timed(quality_number_, quality_times_s_, quality_values_, position());
  quality_times_s_.clear();
  quality_values_.clear();
  return written;
}

core::Status Recorder::write_offsets(const core::Block& raw) {
  const std::int64_t stream_ns = origins_ns_[segment_] + rate_.time_ns(raw.first_scan);
  if (stream_ns >= next_boundary_ns_) {
    DTS_TRY(writer_->write_boundary());
    next_boundary_ns_ = stream_ns + kBoundaryEveryNs;
  }
  if (stream_ns < next_offset_ns_ || writer_->sample_count(columns_.front().number) == 0) return {};
  next_offset_ns_ = stream_ns + kOffsetEveryNs;
  const auto write = [&](std::uint32_t number) -> core::Status {
    if (writer_->sample_count(number) == 0) return {};
    return writer_->write_clock_offset(number, seconds(stream_ns), seconds(offset_ns_));
  };
  for (const Column& column : columns_) {
    DTS_TRY(write(column.number));
  }
  for (const std::uint32_t number : {events_number_, quality_number_}) {
    DTS_TRY(write(number));
  }
  return {};
}

core::Status Recorder::flush() {
  for (Column& column : columns_) {
    DTS_TRY(write_pending(column));
  }
  DTS_TRY(write_events());
  return write_quality();
}

/// Writes the events whose segment has no scan. In a recording without scans they also create a stream with a footer, which holds the
/// reason why the recording is incomplete.
core::Status Recorder::write_waiting() {
  const double at_s = time_s(segment_, next_raw_).value_or(created_at_s_);
  for (const v1::Event& waiting : std::exchange(waiting_events_, {})) events_.emplace_back(at_s, wire::to_json(waiting));
  return write_events();
}

core::Result<XdfWriter::Closed> Recorder::close(const std::string& incomplete) {
  const auto waiting = write_waiting();
  if (!incomplete.empty()) return writer_->close_incomplete(incomplete);
  if (lost_scans_ > 0)
    return writer_->close_incomplete(std::to_string(lost_scans_) + " scans were dropped: the queue to the recorder was full");
  if (!waiting) return tl::make_unexpected(waiting.error());
  return writer_->close();
}

}  // namespace dts::record
