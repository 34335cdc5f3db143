// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/block.h"
#include "core/units.h"
#include "posturography/cop_series.h"

namespace dts::session {

/// Index in the stream "cop" of the first of its scans that is not before a scan of the raw stream.
[[nodiscard]] std::uint64_t cop_index(core::ScanIndex raw, core::Rate raw_rate, core::Rate cop_rate) noexcept;

/// The centre of pressure of the last seconds, and of a trial that is being measured, as it stands in the recording: float32.
class CopTrace {
 public:
  static constexpr std::size_t kMostSamples = 5'000'000;  ///< Nearly an hour at 1500 Hz; 80 MB.
  static constexpr double kKeptS = 5.0;                   ///< Steps of a protocol are told later than the samples that they are about.

  CopTrace(core::Rate raw_rate, core::Rate cop_rate) : raw_rate_(raw_rate), cop_rate_(cop_rate) {}

  /// A block of the stream "cop". One that does not continue the last begins anew: what was lost on the way here stands in the recording,
  /// and is measured there.
  void take(const core::Block& cop);
  /// Samples from here on are not forgotten; nothing: only the last seconds are kept. Raw scans.
  void keep_from(std::optional<core::ScanIndex> first_scan) noexcept { kept_from_ = first_scan; }
  /// Everything before `scan` of `segment` is here, or never comes.
  [[nodiscard]] bool reaches(std::uint32_t segment, core::ScanIndex end_scan) const noexcept;
  [[nodiscard]] double duration_s(core::ScanIndex first_scan, core::ScanIndex end_scan) const noexcept;
  /// The samples of [first_scan, end_scan); nothing when these are not all of `segment`, were lost or forgotten, or did not fit.
  [[nodiscard]] std::optional<posturography::CopSeries> cut(std::uint32_t segment, core::ScanIndex first_scan,
                                                            core::ScanIndex end_scan) const;

 private:
  struct Sample {
    float ml_mm;
    float ap_mm;
    float load_n;
    std::uint32_t quality;
  };

  void drop_old();

  core::Rate raw_rate_;
  core::Rate cop_rate_;
  std::uint32_t segment_ = 0;
  std::uint64_t first_ = 0;  ///< Index of the oldest sample, in scans of the stream "cop".
  std::deque<Sample> samples_;
  std::optional<core::ScanIndex> kept_from_;
};

}  // namespace dts::session
