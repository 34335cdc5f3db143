// SPDX-License-Identifier: Apache-2.0
#include "posturography/measure.h"

#include <algorithm>
#include <cmath>

namespace dts::posturography {
namespace {

struct Row {
  Measure measure;
  MeasureInfo info;
};

constexpr bool kCore = true;      // measures that clinicians compare
constexpr bool kNoRatio = false;  // a quotient of two values is meaningless: angles, exponents, entropies, values that may be negative

// clang-format off: one measure per line
constexpr std::array kRows = {
    Row{Measure::Mdist, {"MDIST", "mm", "Mean distance from the mean position, planar", kCore}},
    Row{Measure::MdistAp, {"MDIST_AP", "mm", "Mean distance from the mean position, anterior-posterior"}},
    Row{Measure::MdistMl, {"MDIST_ML", "mm", "Mean distance from the mean position, medio-lateral"}},
    Row{Measure::Rdist, {"RDIST", "mm", "Root mean square distance from the mean position, planar", kCore}},
    Row{Measure::RdistAp, {"RDIST_AP", "mm", "Root mean square distance from the mean position, anterior-posterior", kCore}},
    Row{Measure::RdistMl, {"RDIST_ML", "mm", "Root mean square distance from the mean position, medio-lateral", kCore}},
    Row{Measure::Totex, {"TOTEX", "mm", "Path length, planar"}},
    Row{Measure::TotexAp, {"TOTEX_AP", "mm", "Path length, anterior-posterior"}},
    Row{Measure::TotexMl, {"TOTEX_ML", "mm", "Path length, medio-lateral"}},
    Row{Measure::Mvelo, {"MVELO", "mm/s", "Mean velocity: path length over duration, planar", kCore}},
    Row{Measure::MveloAp, {"MVELO_AP", "mm/s", "Mean velocity: path length over duration, anterior-posterior", kCore}},
    Row{Measure::MveloMl, {"MVELO_ML", "mm/s", "Mean velocity: path length over duration, medio-lateral", kCore}},
    Row{Measure::Range, {"RANGE", "mm", "Range: largest distance between any two points of the path"}},
    Row{Measure::RangeAp, {"RANGE_AP", "mm", "Range, anterior-posterior", kCore}},
    Row{Measure::RangeMl, {"RANGE_ML", "mm", "Range, medio-lateral", kCore}},
    Row{Measure::Maxdist, {"MAXDIST", "mm", "Largest distance from the mean position, planar"}},
    Row{Measure::MaxdistAp, {"MAXDIST_AP", "mm", "Largest distance from the mean position, anterior-posterior"}},
    Row{Measure::MaxdistMl, {"MAXDIST_ML", "mm", "Largest distance from the mean position, medio-lateral"}},
    Row{Measure::Sd1Ap, {"SD1_AP", "mm", "Sample standard deviation, anterior-posterior"}},
    Row{Measure::Sd1Ml, {"SD1_ML", "mm", "Sample standard deviation, medio-lateral"}},
    Row{Measure::AreaCc, {"AREA_CC", "mm2", "Area of the 95 % confidence circle (Prieto)"}},
    Row{Measure::AreaCe, {"AREA_CE", "mm2", "Area of the 95 % confidence ellipse (Prieto)"}},
    Row{Measure::Pea95F, {"PEA95_F", "mm2", "Area of the 95 % prediction ellipse, by the F distribution", kCore}},
    Row{Measure::Pea95Chi2, {"PEA95_CHI2", "mm2", "Area of the 95 % prediction ellipse, by the chi-square distribution"}},
    Row{Measure::EllSd1, {"ELL_SD1", "mm", "Standard deviation along the major axis of the ellipse"}},
    Row{Measure::EllSd2, {"ELL_SD2", "mm", "Standard deviation along the minor axis of the ellipse"}},
    Row{Measure::EllAngle,
        {"ELL_ANGLE", "deg", "Angle of the major axis of the ellipse, from the subject's right towards the front", false, kNoRatio}},
    Row{Measure::AreaHull, {"AREA_HULL", "mm2", "Area of the convex hull of the path"}},
    Row{Measure::AreaSw, {"AREA_SW", "mm2/s", "Sway area: swept around the mean position per second", kCore}},
    Row{Measure::Mfreq, {"MFREQ", "Hz", "Mean frequency: turns around the mean position that make the path, planar", kCore}},
    Row{Measure::MfreqAp, {"MFREQ_AP", "Hz", "Mean frequency: turns around the mean position that make the path, anterior-posterior"}},
    Row{Measure::MfreqMl, {"MFREQ_ML", "Hz", "Mean frequency: turns around the mean position that make the path, medio-lateral"}},
    Row{Measure::FdCc, {"FD_CC", "1", "Fractal dimension of the path, by the confidence circle", false, kNoRatio}},
    Row{Measure::FdCe, {"FD_CE", "1", "Fractal dimension of the path, by the confidence ellipse", false, kNoRatio}},
    Row{Measure::Lfs, {"LFS", "1/mm", "Path length over area of the 95 % prediction ellipse"}},
    Row{Measure::VmaxAp, {"VMAX_AP", "mm/s", "Largest velocity, anterior-posterior"}},
    Row{Measure::VmaxMl, {"VMAX_ML", "mm/s", "Largest velocity, medio-lateral"}},
    Row{Measure::Aamv1sAp, {"AAMV1S_AP", "mm/s", "Average over windows of 1 s of the largest velocity, anterior-posterior"}},
    Row{Measure::Aamv1sMl, {"AAMV1S_ML", "mm/s", "Average over windows of 1 s of the largest velocity, medio-lateral"}},
    Row{Measure::Aamv2sAp, {"AAMV2S_AP", "mm/s", "Average over windows of 2 s of the largest velocity, anterior-posterior"}},
    Row{Measure::Aamv2sMl, {"AAMV2S_ML", "mm/s", "Average over windows of 2 s of the largest velocity, medio-lateral"}},
    Row{Measure::Aamv5sAp, {"AAMV5S_AP", "mm/s", "Average over windows of 5 s of the largest velocity, anterior-posterior"}},
    Row{Measure::Aamv5sMl, {"AAMV5S_ML", "mm/s", "Average over windows of 5 s of the largest velocity, medio-lateral"}},
    Row{Measure::PowerRd, {"POWER_RD_MT8", "mm2", "Power between 0.15 and 5 Hz, resultant distance"}},
    Row{Measure::PowerAp, {"POWER_AP_MT8", "mm2", "Power between 0.15 and 5 Hz, anterior-posterior"}},
    Row{Measure::PowerMl, {"POWER_ML_MT8", "mm2", "Power between 0.15 and 5 Hz, medio-lateral"}},
    Row{Measure::Pf50Rd, {"PF50_RD_MT8", "Hz", "Median frequency of the power between 0.15 and 5 Hz, resultant distance"}},
    Row{Measure::Pf50Ap, {"PF50_AP_MT8", "Hz", "Median frequency of the power between 0.15 and 5 Hz, anterior-posterior", kCore}},
    Row{Measure::Pf50Ml, {"PF50_ML_MT8", "Hz", "Median frequency of the power between 0.15 and 5 Hz, medio-lateral"}},
    Row{Measure::Pf95Rd, {"PF95_RD_MT8", "Hz", "Frequency below which 95 % of the power between 0.15 and 5 Hz lies, resultant distance"}},
    Row{Measure::Pf95Ap,
        {"PF95_AP_MT8", "Hz", "Frequency below which 95 % of the power between 0.15 and 5 Hz lies, anterior-posterior", kCore}},
    Row{Measure::Pf95Ml, {"PF95_ML_MT8", "Hz", "Frequency below which 95 % of the power between 0.15 and 5 Hz lies, medio-lateral"}},
    Row{Measure::CfreqRd, {"CFREQ_RD_MT8", "Hz", "Centroidal frequency of the power between 0.15 and 5 Hz, resultant distance"}},
    Row{Measure::CfreqAp, {"CFREQ_AP_MT8", "Hz", "Centroidal frequency of the power between 0.15 and 5 Hz, anterior-posterior", kCore}},
    Row{Measure::CfreqMl, {"CFREQ_ML_MT8", "Hz", "Centroidal frequency of the power between 0.15 and 5 Hz, medio-lateral"}},
    Row{Measure::FreqdRd,
        {"FREQD_RD_MT8", "1", "Frequency dispersion: 0 for one frequency, near 1 for many, resultant distance", false, kNoRatio}},
    Row{Measure::FreqdAp,
        {"FREQD_AP_MT8", "1", "Frequency dispersion: 0 for one frequency, near 1 for many, anterior-posterior", false, kNoRatio}},
    Row{Measure::FreqdMl,
        {"FREQD_ML_MT8", "1", "Frequency dispersion: 0 for one frequency, near 1 for many, medio-lateral", false, kNoRatio}},
    Row{Measure::MpfRd, {"MPF_RD_MT8", "Hz", "Mean frequency of the power between 0.15 and 5 Hz, resultant distance"}},
    Row{Measure::MpfAp, {"MPF_AP_MT8", "Hz", "Mean frequency of the power between 0.15 and 5 Hz, anterior-posterior"}},
    Row{Measure::MpfMl, {"MPF_ML_MT8", "Hz", "Mean frequency of the power between 0.15 and 5 Hz, medio-lateral"}},
    Row{Measure::MpfResWelchhalf,
        {"MPF_RES_WELCHHALF", "Hz", "Mean power frequency of both axes over the whole band, by Welch's method with half the record"}},
    Row{Measure::Msd100msRes, {"MSD_RES_100ms", "mm2", "Mean square displacement after 0.1 s, planar"}},
    Row{Measure::Msd100msAp, {"MSD_AP_100ms", "mm2", "Mean square displacement after 0.1 s, anterior-posterior"}},
    Row{Measure::Msd100msMl, {"MSD_ML_100ms", "mm2", "Mean square displacement after 0.1 s, medio-lateral"}},
    Row{Measure::Msd500msRes, {"MSD_RES_500ms", "mm2", "Mean square displacement after 0.5 s, planar"}},
    Row{Measure::Msd500msAp, {"MSD_AP_500ms", "mm2", "Mean square displacement after 0.5 s, anterior-posterior"}},
    Row{Measure::Msd500msMl, {"MSD_ML_500ms", "mm2", "Mean square displacement after 0.5 s, medio-lateral"}},
    Row{Measure::Msd1sRes, {"MSD_RES_1s", "mm2", "Mean square displacement after 1 s, planar"}},
    Row{Measure::Msd1sAp, {"MSD_AP_1s", "mm2", "Mean square displacement after 1 s, anterior-posterior"}},
    Row{Measure::Msd1sMl, {"MSD_ML_1s", "mm2", "Mean square displacement after 1 s, medio-lateral"}},
    Row{Measure::Msd2sRes, {"MSD_RES_2s", "mm2", "Mean square displacement after 2 s, planar"}},
    Row{Measure::Msd2sAp, {"MSD_AP_2s", "mm2", "Mean square displacement after 2 s, anterior-posterior"}},
    Row{Measure::Msd2sMl, {"MSD_ML_2s", "mm2", "Mean square displacement after 2 s, medio-lateral"}},
    Row{Measure::Msd5sRes, {"MSD_RES_5s", "mm2", "Mean square displacement after 5 s, planar"}},
    Row{Measure::Msd5sAp, {"MSD_AP_5s", "mm2", "Mean square displacement after 5 s, anterior-posterior"}},
    Row{Measure::Msd5sMl, {"MSD_ML_5s", "mm2", "Mean square displacement after 5 s, medio-lateral"}},
    Row{Measure::Msd10sRes, {"MSD_RES_10s", "mm2", "Mean square displacement after 10 s, planar"}},
    Row{Measure::Msd10sAp, {"MSD_AP_10s", "mm2", "Mean square displacement after 10 s, anterior-posterior"}},
    Row{Measure::Msd10sMl, {"MSD_ML_10s", "mm2", "Mean square displacement after 10 s, medio-lateral"}},
    Row{Measure::SdaDsRes, {"SDA_DS_RES", "mm2/s", "Short-term diffusion coefficient, planar"}},
    Row{Measure::SdaDsAp, {"SDA_DS_AP", "mm2/s", "Short-term diffusion coefficient, anterior-posterior"}},
    Row{Measure::SdaDsMl, {"SDA_DS_ML", "mm2/s", "Short-term diffusion coefficient, medio-lateral"}},
    Row{Measure::SdaDlRes, {"SDA_DL_RES", "mm2/s", "Long-term diffusion coefficient, planar", false, kNoRatio}},
    Row{Measure::SdaDlAp, {"SDA_DL_AP", "mm2/s", "Long-term diffusion coefficient, anterior-posterior", false, kNoRatio}},
    Row{Measure::SdaDlMl, {"SDA_DL_ML", "mm2/s", "Long-term diffusion coefficient, medio-lateral", false, kNoRatio}},
    Row{Measure::SdaHsRes, {"SDA_HS_RES", "1", "Short-term scaling exponent, planar", false, kNoRatio}},
    Row{Measure::SdaHsAp, {"SDA_HS_AP", "1", "Short-term scaling exponent, anterior-posterior", false, kNoRatio}},
    Row{Measure::SdaHsMl, {"SDA_HS_ML", "1", "Short-term scaling exponent, medio-lateral", false, kNoRatio}},
    Row{Measure::SdaHlRes, {"SDA_HL_RES", "1", "Long-term scaling exponent, planar", false, kNoRatio}},
    Row{Measure::SdaHlAp, {"SDA_HL_AP", "1", "Long-term scaling exponent, anterior-posterior", false, kNoRatio}},
    Row{Measure::SdaHlMl, {"SDA_HL_ML", "1", "Long-term scaling exponent, medio-lateral", false, kNoRatio}},
    Row{Measure::SdaTcRes, {"SDA_TC_RES", "s", "Critical time between short-term and long-term diffusion, planar"}},
    Row{Measure::SdaTcAp, {"SDA_TC_AP", "s", "Critical time between short-term and long-term diffusion, anterior-posterior"}},
    Row{Measure::SdaTcMl, {"SDA_TC_ML", "s", "Critical time between short-term and long-term diffusion, medio-lateral"}},
    Row{Measure::SampenAp, {"SAMPEN_AP_20HZ", "1", "Sample entropy (m = 2, r = 0.2) at 20 Hz, anterior-posterior", kCore, kNoRatio}},
    Row{Measure::SampenMl, {"SAMPEN_ML_20HZ", "1", "Sample entropy (m = 2, r = 0.2) at 20 Hz, medio-lateral", false, kNoRatio}},
    Row{Measure::HcMeanabs, {"HC_MEANABS", "deg", "Mean change of heading per step at 25 Hz (experimental)", false, kNoRatio}},
    Row{Measure::HcSd, {"HC_SD", "deg", "Standard deviation of the change of heading per step at 25 Hz (experimental)", false, kNoRatio}},
    Row{Measure::HcRate, {"HC_RATE", "deg/s", "Mean rate of change of heading at 25 Hz (experimental)", false, kNoRatio}},
    Row{Measure::ApUse, {"AP_USE", "%", "Anterior-posterior range as a part of the foot's length"}},
};
// clang-format on

/// Checks that every measure has a row, in the order of the enumeration, and that no symbol is used twice.
constexpr bool is_complete() {
  for (std::size_t index = 0; index < kRows.size(); ++index) {
    const Row& row = kRows[index];
    if (static_cast<std::size_t>(row.measure) != index || row.info.symbol.empty() || row.info.unit.empty() || row.info.sentence.empty()) {
      return false;
    }
    for (std::size_t other = 0; other < index; ++other) {
      if (kRows[other].info.symbol == row.info.symbol) return false;
    }
  }
  return kRows.size() == kMeasureCount;
}
static_assert(is_complete());

}  // namespace

const MeasureInfo& info(Measure measure) noexcept { return kRows[std::min(static_cast<std::size_t>(measure), kMeasureCount - 1)].info; }

std::optional<Measure> measure_named(std::string_view symbol) noexcept {
  const auto* const row = std::find_if(kRows.begin(), kRows.end(), [symbol](const Row& each) { return each.info.symbol == symbol; });
  if (row == kRows.end()) return std::nullopt;
  return row->measure;
}

void Measures::set(Measure measure, double value) noexcept {
  const auto index = static_cast<std::size_t>(measure);
  if (index >= kMeasureCount) return;
  // Adding 0 turns -0 into 0, so that no angle is shown as "-0".
  values_[index] = std::isfinite(value) ? std::optional(value + 0.0) : std::nullopt;
}

std::size_t Measures::count() const noexcept {
  return static_cast<std::size_t>(std::count_if(values_.begin(), values_.end(), [](const auto& value) { return value.has_value(); }));
}

}  // namespace dts::posturography
