// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::posturography {

/// Remarks about a result, as bits. Recordings store them, so the numbers must not change.
namespace sway_flag {
inline constexpr std::uint32_t kShortRecord = 1U << 0;        ///< Under 10 s or 200 samples: time-domain values only.
inline constexpr std::uint32_t kShortForQuantiles = 1U << 1;  ///< Under 20 s: no PF50, PF95.
inline constexpr std::uint32_t kShortForDiffusion = 1U << 2;  ///< Under 30 s: no stabilogram diffusion.
inline constexpr std::uint32_t kMissingSamples = 1U << 3;     ///< More than 1 % of the samples are missing.
inline constexpr std::uint32_t kCutAtGap = 1U << 4;           ///< A gap of more than 50 ms: the longest clean stretch was analysed.
inline constexpr std::uint32_t kResampled = 1U << 5;          ///< Time stamps were uneven by up to 10 %: linearly interpolated.
inline constexpr std::uint32_t kWindowAveraged = 1U << 6;     ///< Time stamps were uneven by more: averaged over sliding windows.
inline constexpr std::uint32_t kConstant = 1U << 7;           ///< The COP does not move at all.
inline constexpr std::uint32_t kConstantAxis = 1U << 8;       ///< The COP moves along only one axis.
inline constexpr std::uint32_t kOffRates = 1U << 9;     ///< 20 or 25 Hz does not divide the rate: entropy or heading uses the nearest rate.
inline constexpr std::uint32_t kLowRate = 1U << 10;     ///< Below 50 Hz (Scoppa et al. 2013).
inline constexpr std::uint32_t kSteppedOff = 1U << 11;  ///< The load vanished within the trial: invalid.
inline constexpr std::uint32_t kMoved = 1U << 12;       ///< The COP jumped: the feet moved. Invalid.
inline constexpr std::uint32_t kDoubtful = 1U << 13;    ///< A sensor or calibration is in doubt (quality bits of the stream).
inline constexpr std::uint32_t kUnclearCriticalPoint = 1U << 14;  ///< On at least one axis D_S is not above 2 D_L.
inline constexpr std::uint32_t kLongForEntropy = 1U << 15;        ///< More than an hour: no entropy, because its cost grows with the
                                                                  ///< square.
inline constexpr std::uint32_t kCount = 16;
inline constexpr std::uint32_t kInvalid = kSteppedOff | kMoved;
}  // namespace sway_flag

/// Returns "short_record", "cut_at_gap", ... in the order of the bits.
[[nodiscard]] std::vector<std::string_view> names_of(std::uint32_t flags);
/// Returns the sentence for one bit.
[[nodiscard]] std::string_view sentence_of(std::uint32_t flag);

/// An evenly sampled centre of pressure, unprocessed: ML positive to the subject's right, AP positive forward, mm. All columns have the
/// same length; NaN where a sample is missing.
struct CopSeries {
  double rate_hz = 0.0;
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
  std::vector<double> load_n{};  ///< Empty: unknown.
  std::uint32_t flags = 0;       ///< Flags known before the analysis (resampling, doubtful sensors).
};

/// Creates an even series from samples with time stamps. Even stamps: keeps the samples, with NaN where rows are missing, at the simplest
/// rate (whole Hz) that the written digits allow. Stamps uneven by less than 10 % of a step: interpolates linearly. Others: averages over
/// sliding windows (Audiffren & Contal 2016). `load_n` may be empty. Fails with InvalidArgument if there are fewer than two rows, if times
/// do not rise or are not finite, if columns differ in length, or if the gaps exceed 1e6 samples plus 16 for every row. Thread: any.
[[nodiscard]] core::Result<CopSeries> even_series(std::span<const double> t_s, std::span<const double> ml_mm, std::span<const double> ap_mm,
                                                  std::span<const double> load_n = {});

}  // namespace dts::posturography
