// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/event.h"
#include "core/frame.h"
#include "core/rate.h"
#include "dts/v1/stream.pb.h"
#include "record/losses.h"
#include "record/session_facts.h"
#include "record/stream_info.h"
#include "record/xdf/xdf_writer.h"

namespace dts::record {

/// One stream of a rig's frames, and how it is recorded.
struct RecordedStream {
  std::size_t frame_index = 0;  ///< In `Frame::streams`.
  StreamInfo info;              ///< Regular; name, rate and channels as in the frame.
};

/// Writes frames to a file: scans as chunks of at most 0.2 s, quality bits as a stream of changes, everything else as events, and the
/// drift of the device's clock as clock offsets.
///
/// Computes every time stamp: start of the segment + scan / exact rate. The start is the host time of the segment's first scan. The drift
/// of the device's clock since then is in the clock offsets (every 5 s), as XDF specifies. So the time axis of a segment has no jitter,
/// and readers can map it to the host's clock. A new segment keeps the current offset. Thread: one at a time.
class Recorder {
 public:
  /// Creates the file (see XdfWriter::create: it is safe on the disk before this returns). The first stream must be "<rig>/raw": its blocks
  /// define segments and scans. A stream without samples has no header in the file.
  [[nodiscard]] static core::Result<std::unique_ptr<Recorder>> create(const std::string& file, const SessionFacts& facts,
                                                                      std::vector<RecordedStream> streams);

  /// Sets the state of the stages before the first frame. Call it before the first `take`.
  void set_stage_state(std::span<const double> state);
  /// Buffers a frame and the events found in it; writes every chunk that is full.
  [[nodiscard]] core::Status take(const core::Frame& frame, std::span<const core::Event> events);
  /// Buffers an event. If no frame of its segment was recorded yet, the event waits for the first one. If that segment is never recorded,
  /// the event moves to the start of the next segment, or to the end of the recording.
  [[nodiscard]] core::Status take(const v1::Event& event);
  /// Writes everything that is buffered.
  [[nodiscard]] core::Status flush();
  [[nodiscard]] core::Status synchronise() { return writer_->synchronise(); }
  /// Closes the file; call `flush` before. `incomplete`: why the recording is not complete; empty: it is complete.
  [[nodiscard]] core::Result<XdfWriter::Closed> close(const std::string& incomplete);

  [[nodiscard]] std::uint64_t bytes() const noexcept { return writer_->bytes(); }
  /// Scans in the file, without buffered scans and scans lost to an error.
  [[nodiscard]] std::uint64_t scans() const noexcept { return writer_->sample_count(columns_.front().number); }
  /// Duration of the data in the file: from its first scan to the end of its last, gaps included.
  [[nodiscard]] double duration_s() const noexcept { return end_s_ - begin_s_; }
  /// Scans lost between the pipeline and this recorder.
  [[nodiscard]] std::uint64_t lost_scans() const noexcept { return lost_scans_; }
  /// Segment of the newest frame.
  [[nodiscard]] std::uint32_t segment() const noexcept { return segment_; }
  /// Counts `scans` lost after the newest frame, where no later frame shows the jump.
  void note_loss(std::uint64_t scans);
  /// All scans missing between the first and the last, whatever the reason.
  [[nodiscard]] const core::Losses& losses() const noexcept { return losses_.losses(); }

 private:
  struct Column {
    RecordedStream recorded;
    std::uint32_t number = 0;     ///< Stream number in the file.
    std::size_t chunk_scans = 1;  ///< Most scans in one chunk.
    std::int64_t origin_ns = 0;   ///< Stream time of scan 0 of the segment.
    bool has_origin = false;
    std::vector<double> pending{};  ///< Scan by scan.
    core::ScanIndex first_pending{};
    core::ScanIndex next{};  ///< The scan that continues the chunk.
  };
  explicit Recorder(std::unique_ptr<XdfWriter> writer) : writer_(std::move(writer)) {}

  core::Status begin_segment(const core::Frame& frame);
  void note_jump(const core::Block& raw);
  core::Status write_block(Column& column, const core::Block& block, const core::Block& raw);
  void write_quality(const core::Frame& frame);
  void keep(const v1::Event& event);
  core::Status write_pending(Column& column);
  core::Status write_events();
  core::Status write_quality();
  core::Status write_offsets(const core::Block& raw);
  core::Status write_waiting();
  [[nodiscard]] std::optional<double> time_s(std::uint32_t segment, core::ScanIndex scan) const noexcept;
  [[nodiscard]] XdfWriter::Position position() const noexcept { return {.segment = segment_, .first_scan = next_raw_}; }

  std::unique_ptr<XdfWriter> writer_;
  std::vector<Column> columns_;
  std::vector<std::size_t> quality_sources_;  ///< Frame indices of the streams whose quality bits are recorded: raw and aux.
  std::uint32_t events_number_ = 0;
  std::uint32_t quality_number_ = 0;
  core::Rate rate_;
  double created_at_s_ = 0.0;  ///< Host clock (CLOCK_MONOTONIC).

  std::uint32_t segment_ = 0;
  std::map<std::uint32_t, std::int64_t> origins_ns_;  ///< Stream time of scan 0 of the raw stream, by segment.
  std::int64_t offset_ns_ = 0;                        ///< Host clock minus stream time, newest.
  std::int64_t next_offset_ns_ = 0;                   ///< Stream time of the next clock offset in the file.
  std::int64_t next_boundary_ns_ = 0;
  core::ScanIndex next_raw_;
  core::Gap gap_;  ///< The gap before the next segment; written with its event.
  std::uint64_t lost_scans_ = 0;
  LossCounter losses_;
  double begin_s_ = 0.0;  ///< Begin and end of the written raw stream, in stream time.
  double end_s_ = 0.0;

  std::vector<v1::Event> waiting_events_;  ///< Events of segments without a recorded frame.
  std::vector<std::pair<double, std::string>> events_;
  std::vector<double> quality_times_s_;
  std::vector<double> quality_values_;
  std::vector<std::uint8_t> last_quality_;
  bool is_quality_due_ = true;  ///< True: the bits of the next scan are written even if unchanged.
};

}  // namespace dts::record
