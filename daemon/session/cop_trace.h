// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "core/block.h"
#include "core/units.h"
#include "posturography/cop_series.h"

namespace dts::session {

/// Index in the stream "cop" of the first of its scans that is not before a scan of the raw stream.
[[nodiscard]] std::uint64_t cop_index(core::ScanIndex raw, core::Rate raw_rate, core::Rate cop_rate) noexcept;

/// A scan of the raw stream, in its segment.
struct TracePlace {
  std::uint32_t segment = 0;
  core::ScanIndex scan;
};

/// The centre of pressure of the last seconds, and of a trial that is being measured, as it stands in the recording: float32.
///
///     segment 3            gap     segment 4
///     |================|  . . . .  |===========>     within a trial the gap is as many missing samples as its time says
class CopTrace {
 public:
  static constexpr std::size_t kMostSamples = 5'000'000;  ///< Nearly an hour at 1500 Hz; 80 MB.
  static constexpr double kKeptS = 5.0;                   ///< Steps of a protocol are told later than the samples that they are about.

  CopTrace(core::Rate raw_rate, core::Rate cop_rate) : raw_rate_(raw_rate), cop_rate_(cop_rate) {}

  /// A block of the stream "cop". One that does not continue its segment begins anew: what was lost on the way here stands in the recording,
  /// and is measured there.
  void take(const core::Block& cop);
  /// Samples from here on are not forgotten; nothing: only the last seconds are kept.
  void keep_from(std::optional<TracePlace> first) noexcept { kept_from_ = first; }
  /// Everything of `segment` before `end_scan` is here, or never comes.
  [[nodiscard]] bool reaches(const TracePlace& end) const noexcept;
  /// The samples of [first, end), NaN where a gap is; nothing when these are not all here: lost, forgotten, or more than fit.
  [[nodiscard]] std::optional<posturography::CopSeries> cut(const TracePlace& first, const TracePlace& end) const;

 private:
  struct Sample {
    float ml_mm;
    float ap_mm;
    float load_n;
    std::uint32_t quality;
  };
  /// Samples of one segment. Numbers count all samples ever taken, missing ones too.
  struct Stretch {
    std::uint32_t segment = 0;
    std::uint64_t first_index = 0;   ///< In the stream "cop" of this segment,
    std::uint64_t first_number = 0;  ///< and its number.
  };

  [[nodiscard]] bool continues(const core::Block& cop) const noexcept;
  [[nodiscard]] std::optional<std::uint64_t> samples_missing(const core::Block& cop) const noexcept;
  [[nodiscard]] std::optional<std::uint64_t> number_of(const TracePlace& place) const noexcept;
  [[nodiscard]] std::uint64_t end_number() const noexcept { return begin_number_ + samples_.size(); }
  void drop_old();

  core::Rate raw_rate_;
  core::Rate cop_rate_;
  std::deque<Stretch> stretches_;
  std::uint64_t begin_number_ = 0;  ///< Of the oldest sample.
  std::deque<Sample> samples_;
  std::int64_t end_host_ns_ = 0;  ///< When the sample after the newest is due.
  std::optional<TracePlace> kept_from_;
};

}  // namespace dts::session
