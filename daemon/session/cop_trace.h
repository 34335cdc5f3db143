// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "core/block.h"
#include "core/units.h"
#include "posturography/cop_series.h"

namespace dts::session {

/// Returns the index in the stream "cop" of its first scan that is not earlier than the raw scan `raw`.
[[nodiscard]] std::uint64_t cop_index(core::ScanIndex raw, core::Rate raw_rate, core::Rate cop_rate) noexcept;

/// A scan of the raw stream within its segment.
struct TracePlace {
  std::uint32_t segment = 0;
  core::ScanIndex scan;
};

/// A sample of the centre of pressure, as float32 like the recording.
struct CopSample {
  float ml_mm;
  float ap_mm;
  float load_n;
  std::uint32_t quality;
};
/// Samples are written once, in order, and never moved: another thread may read the written ones meanwhile.
using CopChunk = std::array<CopSample, 4096>;

/// Consecutive samples that a trace has written. It costs little to make; copying the samples (900,000 in 10 min at 1500 Hz) is left to the
/// thread that needs them. Thread: any, also while the trace continues.
class CopCut {
 public:
  CopCut(std::vector<std::shared_ptr<const CopChunk>> chunks, std::size_t first, std::size_t count, double rate_hz)
      : chunks_(std::move(chunks)), first_(first), count_(count), rate_hz_(rate_hz) {}

  [[nodiscard]] double duration_s() const noexcept { return static_cast<double>(count_) / rate_hz_; }
  /// Returns the samples, with NaN for gaps.
  [[nodiscard]] posturography::CopSeries series() const;

 private:
  std::vector<std::shared_ptr<const CopChunk>> chunks_;
  std::size_t first_;  ///< In the first chunk.
  std::size_t count_;
  double rate_hz_;
};

/// Keeps the centre of pressure of the last seconds and of the trials being measured.
///
///     segment 3            gap     segment 4
///     |================|  . . . .  |===========>     within a trial, a gap becomes missing samples (NaN), as many as fit its duration
class CopTrace {
 public:
  static constexpr std::size_t kMostSamples = 5'000'000;  ///< Almost one hour at 1500 Hz; 80 MB.
  /// Events of a protocol arrive later than the samples that they refer to: after an undo by 5 s, and by what frames may be late.
  static constexpr double kKeptS = 10.0;

  CopTrace(core::Rate raw_rate, core::Rate cop_rate) : raw_rate_(raw_rate), cop_rate_(cop_rate) {}

  /// Adds a block of the stream "cop". Deletes all samples if the block does not continue its segment, except after a gap within a trial.
  /// Scans that were lost before this point are in the recording and are measured there.
  void take(const core::Block& cop);
  /// Keeps all samples from `first` on; without `first`, keeps only the last seconds.
  void keep_from(std::optional<TracePlace> first) noexcept { kept_from_ = first; }
  /// Returns whether no further sample before `end` can arrive.
  [[nodiscard]] bool reaches(const TracePlace& end) const noexcept;
  /// Returns how many samples the trace has had since `place`, missing ones included: 0 if it has not reached `place`, and the largest
  /// number if the segment of `place` is not kept.
  [[nodiscard]] std::uint64_t samples_since(const TracePlace& place) const noexcept;
  /// Returns the samples of [first, end); nothing if any of them is not kept: lost, deleted, or beyond the limit.
  [[nodiscard]] std::optional<CopCut> cut(const TracePlace& first, const TracePlace& end) const;

 private:
  /// Consecutive samples of one segment. Sample numbers count all samples since the start, missing ones too.
  struct Stretch {
    std::uint32_t segment = 0;
    std::uint64_t first_index = 0;   ///< Index of the first sample in the stream "cop" of this segment.
    std::uint64_t first_number = 0;  ///< Number of the same sample.
  };

  [[nodiscard]] bool continues(const core::Block& cop) const noexcept;
  [[nodiscard]] std::optional<std::uint64_t> samples_missing(const core::Block& cop) const noexcept;
  [[nodiscard]] std::optional<std::uint64_t> number_of(const TracePlace& place) const noexcept;
  void append(const CopSample& sample);
  void drop_old();

  core::Rate raw_rate_;
  core::Rate cop_rate_;
  std::deque<Stretch> stretches_;
  std::uint64_t begin_number_ = 0;  ///< Number of the oldest sample kept,
  std::uint64_t end_number_ = 0;    ///< of the next sample,
  std::uint64_t chunk_number_ = 0;  ///< and of the first sample in the chunks.
  std::deque<std::shared_ptr<CopChunk>> chunks_;
  std::int64_t end_host_ns_ = 0;  ///< Host time at which the next sample is due.
  std::optional<TracePlace> kept_from_;
};

}  // namespace dts::session
