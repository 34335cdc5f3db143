// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace dts::posturography {

/// Every measure of the centre of pressure. In a family of three, the first is planar (or of the resultant distance), the second AP, the
/// third ML: `of(Measure::Mdist, Axis::Ml)`.
// clang-format off: one family per line
enum class Measure : std::uint8_t {
  // Prieto et al. 1996: time domain
  Mdist,
  MdistAp,
  MdistMl,
  Rdist,
  RdistAp,
  RdistMl,
  Totex,
  TotexAp,
  TotexMl,
  Mvelo,
  MveloAp,
  MveloMl,
  Range,
  RangeAp,
  RangeMl,
  Maxdist,
  MaxdistAp,
  MaxdistMl,
  Sd1Ap,
  Sd1Ml,
  // areas
  AreaCc,
  AreaCe,
  Pea95F,
  Pea95Chi2,
  EllSd1,
  EllSd2,
  EllAngle,
  AreaHull,
  AreaSw,
  // hybrid
  Mfreq,
  MfreqAp,
  MfreqMl,
  FdCc,
  FdCe,
  Lfs,
  // velocity
  VmaxAp,
  VmaxMl,
  Aamv1sAp,
  Aamv1sMl,
  Aamv2sAp,
  Aamv2sMl,
  Aamv5sAp,
  Aamv5sMl,
  // frequency domain: RD, AP, ML
  PowerRd,
  PowerAp,
  PowerMl,
  Pf50Rd,
  Pf50Ap,
  Pf50Ml,
  Pf95Rd,
  Pf95Ap,
  Pf95Ml,
  CfreqRd,
  CfreqAp,
  CfreqMl,
  FreqdRd,
  FreqdAp,
  FreqdMl,
  MpfRd,
  MpfAp,
  MpfMl,
  MpfResWelchhalf,
  // random walk: RES, AP, ML
  Msd100msRes,
  Msd100msAp,
  Msd100msMl,
  Msd500msRes,
  Msd500msAp,
  Msd500msMl,
  Msd1sRes,
  Msd1sAp,
  Msd1sMl,
  Msd2sRes,
  Msd2sAp,
  Msd2sMl,
  Msd5sRes,
  Msd5sAp,
  Msd5sMl,
  Msd10sRes,
  Msd10sAp,
  Msd10sMl,
  SdaDsRes,
  SdaDsAp,
  SdaDsMl,
  SdaDlRes,
  SdaDlAp,
  SdaDlMl,
  SdaHsRes,
  SdaHsAp,
  SdaHsMl,
  SdaHlRes,
  SdaHlAp,
  SdaHlMl,
  SdaTcRes,
  SdaTcAp,
  SdaTcMl,
  // regularity and direction
  SampenAp,
  SampenMl,
  HcMeanabs,
  HcSd,
  HcRate,
  // stability limits
  ApUse,
};
// clang-format on
inline constexpr std::size_t kMeasureCount = static_cast<std::size_t>(Measure::ApUse) + 1;

enum class Axis : std::uint8_t { Planar = 0, Ap = 1, Ml = 2 };

/// Returns the member of a family of three for an axis; `family` is the first member.
[[nodiscard]] constexpr Measure of(Measure family, Axis axis) noexcept {
  return static_cast<Measure>(static_cast<std::uint8_t>(family) + static_cast<std::uint8_t>(axis));
}

/// Description of a measure.
struct MeasureInfo {
  std::string_view symbol;    ///< "MVELO_AP": as in the posturography sheet.
  std::string_view unit;      ///< "mm", "mm/s", "mm2", "mm2/s", "Hz", "s", "deg", "deg/s", "1", "1/mm", "%"
  std::string_view sentence;  ///< "Mean velocity, anterior-posterior"
  /// One of the measures for summaries, comparisons and reference ranges.
  bool is_core = false;
  /// Always above 0, so that a quotient of two values (Romberg) is meaningful.
  bool is_ratio_scaled = true;
};

[[nodiscard]] const MeasureInfo& info(Measure measure) noexcept;
/// Finds a measure by its symbol; returns nothing if there is none.
[[nodiscard]] std::optional<Measure> measure_named(std::string_view symbol) noexcept;

/// Values of measures: finite, or absent if undefined. Never NaN, never 0 for "unknown".
class Measures {
 public:
  /// A value that is not finite stays absent.
  void set(Measure measure, double value) noexcept;
  [[nodiscard]] std::optional<double> get(Measure measure) const noexcept { return values_[static_cast<std::size_t>(measure)]; }
  [[nodiscard]] bool has(Measure measure) const noexcept { return get(measure).has_value(); }
  [[nodiscard]] std::size_t count() const noexcept;

  friend bool operator==(const Measures&, const Measures&) = default;

 private:
  std::array<std::optional<double>, kMeasureCount> values_{};
};

}  // namespace dts::posturography
