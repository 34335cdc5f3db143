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
#include "record/event.h"
#include "record/losses.h"
#include "record/session_facts.h"
#include "record/stream_info.h"
#include "record/xdf/xdf_writer.h"

namespace dts::record {

/// Which streams of a rig's frames are recorded, and as what.
struct RecordedStream {
  std::size_t frame_index = 0;  ///< In `Frame::streams`.
  StreamInfo info;              ///< Regular; name, rate and channels as in the frame.
};

/// Turns frames into a file: scans into chunks of at most a quarter of a second, quality bits into a stream of changes, everything else
/// into events, and the drift of the device's clock into clock offsets.
///
/// Time stamps are computed, never measured: start of the segment + scan / exact rate. The start is the host time of the segment's first
/// scan; what the device's clock has drifted since stands in the clock offsets (every 5 s), as XDF means it, so that the time axis of a
/// segment has no jitter at all and yet maps to the host's clock. A new segment starts by the same mapping: the offset goes on. Thread: one
/// at a time.
class Recorder {
 public:
  /// Creates the file (see XdfWriter::create: it is safe on the disk before this returns). The first stream must be "<rig>/raw": it decides
  /// about segments and scans. Streams that never deliver have no header.
  [[nodiscard]] static core::Result<std::unique_ptr<Recorder>> create(const std::string& file, const SessionFacts& facts,
                                                                      std::vector<RecordedStream> streams);

  /// State of the stages before the first frame. Before the first `take`.
  void set_stage_state(std::span<const double> state);
  /// Buffers a frame with the events that were noticed in it; writes what has become a chunk.
  [[nodiscard]] core::Status take(const core::Frame& frame, std::span<const core::Event> events = {});
  /// Of a segment that is not known yet (nothing was recorded): it waits for its first frame. When none comes, the event goes to the start
  /// of the next segment, or to the end of the recording.
  [[nodiscard]] core::Status take(const RecordedEvent& event);
  /// Writes all that is buffered.
  [[nodiscard]] core::Status flush();
  [[nodiscard]] core::Status synchronise() { return writer_->synchronise(); }
  /// After `flush`. `incomplete` empty: the recording is whole.
  [[nodiscard]] core::Result<XdfWriter::Closed> close(const std::string& incomplete);

  [[nodiscard]] std::uint64_t bytes() const noexcept { return writer_->bytes(); }
  /// Scans that stand in the file: what is buffered, or was lost to an error, is not counted.
  [[nodiscard]] std::uint64_t scans() const noexcept { return writer_->sample_count(columns_.front().number); }
  /// Of what stands in the file: from its first scan to the end of its last, gaps included.
  [[nodiscard]] double duration_s() const noexcept { return end_s_ - begin_s_; }
  /// Scans that were lost between the pipeline and here.
  [[nodiscard]] std::uint64_t lost_scans() const noexcept { return lost_scans_; }
  /// Of the newest frame.
  [[nodiscard]] std::uint32_t segment() const noexcept { return segment_; }
  /// Counts `scans` that no jump between two frames shows: behind the newest frame.
  void note_loss(std::uint64_t scans);
  /// All that is missing between the first scan and the last, whoever lost it.
  [[nodiscard]] const core::Losses& losses() const noexcept { return losses_.losses(); }

 private:
  struct Column {
    RecordedStream recorded;
    std::uint32_t number = 0;     ///< In the file.
    std::size_t chunk_scans = 1;  ///< Never more in one chunk.
    std::int64_t origin_ns = 0;   ///< Stream time of scan 0 of the segment.
    bool has_origin = false;
    std::vector<double> pending{};  ///< Scan by scan.
    core::ScanIndex first_pending{};
    core::ScanIndex next{};  ///< What continues the chunk.
  };
  explicit Recorder(std::unique_ptr<XdfWriter> writer) : writer_(std::move(writer)) {}

  core::Status begin_segment(const core::Frame& frame);
  void note_jump(const core::Block& raw);
  core::Status take_block(Column& column, const core::Block& block, const core::Block& raw);
  void take_quality(const core::Frame& frame);
  void keep(const core::Event& event);
  void keep(const RecordedEvent& event);
  core::Status write_pending(Column& column);
  core::Status write_events();
  core::Status write_quality();
  core::Status write_offsets(const core::Block& raw);
  core::Status write_waiting();
  [[nodiscard]] std::optional<double> time_s(std::uint32_t segment, core::ScanIndex scan) const noexcept;
  [[nodiscard]] XdfWriter::Position position() const noexcept { return {.segment = segment_, .first_scan = next_raw_}; }

  std::unique_ptr<XdfWriter> writer_;
  std::vector<Column> columns_;
  std::vector<std::size_t> quality_sources_;  ///< Frame indices of the streams whose bits are recorded: raw, and aux.
  std::uint32_t events_number_ = 0;
  std::uint32_t quality_number_ = 0;
  core::Rate rate_;
  double created_at_s_ = 0.0;  ///< Host clock.

  std::uint32_t segment_ = 0;
  std::map<std::uint32_t, std::int64_t> origins_ns_;  ///< Stream time of scan 0 of the raw stream, by segment.
  std::int64_t offset_ns_ = 0;                        ///< Host clock minus stream time, newest.
  std::int64_t next_offset_ns_ = 0;                   ///< Stream time at which it is written next.
  std::int64_t next_boundary_ns_ = 0;
  core::ScanIndex next_raw_;
  core::Gap gap_;  ///< Stands before the next scan.
  std::uint64_t lost_scans_ = 0;
  LossCounter losses_;
  double begin_s_ = 0.0;  ///< Of the raw stream, as far as it is written; stream time.
  double end_s_ = 0.0;

  std::vector<RecordedEvent> waiting_events_;  ///< Of segments that are not known yet.
  std::vector<std::pair<double, std::string>> events_;
  std::vector<double> quality_times_s_;
  std::vector<double> quality_values_;
  std::vector<std::uint8_t> last_quality_;
  bool is_quality_due_ = true;  ///< The next scan's bits are written, changed or not.
};

}  // namespace dts::record
