// SPDX-License-Identifier: Apache-2.0
#include "report/measure_tables.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "report/number_text.h"
#include "report/reference_columns.h"

namespace dts::report {
namespace {

using posturography::Analysis;
using posturography::info;
using posturography::Measure;

enum class Shape { Triple, Pair, Single };

/// One row of the table of all measures; `first` is the family's first member; a heading has none.
struct FamilyRow {
  std::string_view label;
  Shape shape = Shape::Triple;
  std::optional<Measure> first{};
};

// clang-format off: one row per line
constexpr std::array kFamilies = {
    FamilyRow{"Distance from the mean"},
    FamilyRow{"Mean distance (MDIST)", Shape::Triple, Measure::Mdist},
    FamilyRow{"Root mean square distance (RDIST)", Shape::Triple, Measure::Rdist},
    FamilyRow{"Largest distance (MAXDIST)", Shape::Triple, Measure::Maxdist},
    FamilyRow{"Range between two points (RANGE)", Shape::Triple, Measure::Range},
    FamilyRow{"Standard deviation (SD1)", Shape::Pair, Measure::Sd1Ap},
    FamilyRow{"Path and velocity"},
    FamilyRow{"Path length (TOTEX)", Shape::Triple, Measure::Totex},
    FamilyRow{"Mean velocity (MVELO)", Shape::Triple, Measure::Mvelo},
    FamilyRow{"Largest velocity (VMAX)", Shape::Pair, Measure::VmaxAp},
    FamilyRow{"Largest velocity per 1 s, mean (AAMV)", Shape::Pair, Measure::Aamv1sAp},
    FamilyRow{"Largest velocity per 2 s, mean (AAMV)", Shape::Pair, Measure::Aamv2sAp},
    FamilyRow{"Largest velocity per 5 s, mean (AAMV)", Shape::Pair, Measure::Aamv5sAp},
    FamilyRow{"Mean frequency (MFREQ)", Shape::Triple, Measure::Mfreq},
    FamilyRow{"Area and shape"},
    FamilyRow{"95 % prediction ellipse (PEA95-F)", Shape::Single, Measure::Pea95F},
    FamilyRow{"The same by chi-square (PEA95-CHI2)", Shape::Single, Measure::Pea95Chi2},
    FamilyRow{"95 % confidence ellipse (AREA-CE)", Shape::Single, Measure::AreaCe},
    FamilyRow{"95 % confidence circle (AREA-CC)", Shape::Single, Measure::AreaCc},
    FamilyRow{"Convex hull (AREA-HULL)", Shape::Single, Measure::AreaHull},
    FamilyRow{"Sway area per second (AREA-SW)", Shape::Single, Measure::AreaSw},
    FamilyRow{"SD along the major axis (ELL-SD1)", Shape::Single, Measure::EllSd1},
    FamilyRow{"SD along the minor axis (ELL-SD2)", Shape::Single, Measure::EllSd2},
    FamilyRow{"Major axis from ML (ELL-ANGLE)", Shape::Single, Measure::EllAngle},
    FamilyRow{"Path over ellipse area (LFS)", Shape::Single, Measure::Lfs},
    FamilyRow{"Fractal dimension, circle (FD-CC)", Shape::Single, Measure::FdCc},
    FamilyRow{"Fractal dimension, ellipse (FD-CE)", Shape::Single, Measure::FdCe},
    FamilyRow{"Spectrum, 0.15-5 Hz, 8 sine tapers (first column: RD)"},
    FamilyRow{"POWER", Shape::Triple, Measure::PowerRd},
    FamilyRow{"Median frequency (PF50)", Shape::Triple, Measure::Pf50Rd},
    FamilyRow{"Frequency with 95 % of power (PF95)", Shape::Triple, Measure::Pf95Rd},
    FamilyRow{"Centroidal frequency (CFREQ)", Shape::Triple, Measure::CfreqRd},
    FamilyRow{"Mean power frequency (MPF)", Shape::Triple, Measure::MpfRd},
    FamilyRow{"Frequency dispersion (FREQD)", Shape::Triple, Measure::FreqdRd},
    FamilyRow{"The same, both axes, Welch (MPF)", Shape::Single, Measure::MpfResWelchhalf},
    FamilyRow{"Random walk (MSD: mean square displacement)"},
    FamilyRow{"MSD after 0.1 s", Shape::Triple, Measure::Msd100msRes},
    FamilyRow{"MSD after 0.5 s", Shape::Triple, Measure::Msd500msRes},
    FamilyRow{"MSD after 1 s", Shape::Triple, Measure::Msd1sRes},
    FamilyRow{"MSD after 2 s", Shape::Triple, Measure::Msd2sRes},
    FamilyRow{"MSD after 5 s", Shape::Triple, Measure::Msd5sRes},
    FamilyRow{"MSD after 10 s", Shape::Triple, Measure::Msd10sRes},
    FamilyRow{"Short-term diffusion (D-S)", Shape::Triple, Measure::SdaDsRes},
    FamilyRow{"Long-term diffusion (D-L)", Shape::Triple, Measure::SdaDlRes},
    FamilyRow{"Short-term exponent (H-S)", Shape::Triple, Measure::SdaHsRes},
    FamilyRow{"Long-term exponent (H-L)", Shape::Triple, Measure::SdaHlRes},
    FamilyRow{"Critical time (TC)", Shape::Triple, Measure::SdaTcRes},
    FamilyRow{"Regularity and direction"},
    FamilyRow{"Sample entropy, m = 2, r = 0.2, 20 Hz", Shape::Pair, Measure::SampenAp},
    FamilyRow{"Mean change of heading (HC, exp.)", Shape::Single, Measure::HcMeanabs},
    FamilyRow{"SD of change of heading (HC, exp.)", Shape::Single, Measure::HcSd},
    FamilyRow{"Rate of change of heading (HC, exp.)", Shape::Single, Measure::HcRate},
    FamilyRow{"AP range of foot length (AP-USE)", Shape::Single, Measure::ApUse},
};
// clang-format on

bool is_between(Measure measure, Measure first, Measure last) { return measure >= first && measure <= last; }

/// The cells of one table, with a letter for the reason of each missing value: "- a".
class Cells {
 public:
  explicit Cells(const TrialData& trial) : trial_(trial) {}

  [[nodiscard]] std::string of(Measure measure) {
    if (!trial_.analysis) return "-";
    if (const auto value = trial_.analysis->measures.get(measure)) return significant(*value);
    const std::string reason = why_absent(measure, *trial_.analysis);
    auto found = std::ranges::find(reasons_, reason);
    if (found == reasons_.end()) found = reasons_.insert(found, reason);
    return "- " + std::string(1, static_cast<char>('a' + (found - reasons_.begin())));
  }
  [[nodiscard]] std::vector<std::string> footnotes() const {
    std::string text;
    for (std::size_t index = 0; index < reasons_.size(); ++index) {
      text += (text.empty() ? "" : "; ") + std::string(1, static_cast<char>('a' + index)) + ": " + reasons_[index];
    }
    if (text.empty()) return {};
    return {"-: no value. " + text + "."};
  }

 private:
  const TrialData& trial_;
  std::vector<std::string> reasons_{};  // a few: fewer than there are letters
};

/// Shortens a sentence: the axis of "Mean velocity: path length over duration, anterior-posterior" becomes a short word.
std::string short_sentence(std::string_view sentence) {
  std::string text(sentence);
  const auto replace = [&text](std::string_view from, std::string_view to) {
    if (const std::size_t at = text.find(from); at != std::string::npos) text.replace(at, from.size(), to);
  };
  replace(", anterior-posterior", ", AP");
  replace(", medio-lateral", ", ML");
  replace(", planar", "");
  replace(": path length over duration", "");
  replace(": turns around the mean position that make the path", "");
  replace("Frequency below which 95 % of the power between 0.15 and 5 Hz lies", "95 % power frequency");
  replace(" of the power between 0.15 and 5 Hz", "");
  replace("Centroidal", "Centroid");
  replace("Root mean square distance from the mean position", "RMS distance");
  replace("Mean distance from the mean position", "Mean distance");
  replace("Area of the 95 % prediction ellipse, by the F distribution", "95 % ellipse (PEA95-F)");
  replace("Sway area: swept around the mean position per second", "Sway area per second");
  replace(" (m = 2, r = 0.2) at 20 Hz", "");
  return text;
}

}  // namespace

std::string measure_name(Measure measure) { return short_sentence(info(measure).sentence); }

std::string measure_label(Measure measure) {
  std::string name = measure_name(measure);
  return name.ends_with(')') ? name : name + " (" + std::string(info(measure).symbol) + ")";
}

std::string why_absent(Measure measure, const Analysis& analysis) {
  using namespace posturography::sway_flag;
  const bool is_spectral = is_between(measure, Measure::PowerRd, Measure::MpfResWelchhalf);
  const bool is_quantile = is_between(measure, Measure::Pf50Rd, Measure::Pf95Ml);
  const bool is_walk = is_between(measure, Measure::Msd100msRes, Measure::SdaTcMl);
  const bool is_diffusion = is_between(measure, Measure::SdaDsRes, Measure::SdaTcMl);
  const bool is_regularity = is_between(measure, Measure::SampenAp, Measure::HcRate);
  if (measure == Measure::ApUse) return "the foot length is not given (field foot_length_cm)";
  if ((analysis.flags & kConstant) != 0) return "not defined: the COP does not move";
  if ((analysis.flags & kShortRecord) != 0 && (is_spectral || is_walk || is_regularity)) return "needs 10 s and 200 samples";
  if ((analysis.flags & kShortForQuantiles) != 0 && is_quantile) return "needs 20 s";
  if ((analysis.flags & kShortForDiffusion) != 0 && is_diffusion) return "needs 30 s";
  if ((analysis.flags & kConstantAxis) != 0) return "not defined: the COP moves along one axis only";
  if (is_between(measure, Measure::SdaTcRes, Measure::SdaTcMl)) return "defined only if D-S > D-L and the lines cross below 10 s";
  if (is_between(measure, Measure::Msd100msRes, Measure::Msd10sMl)) return "lag above half the duration";
  return "not defined for this record";
}

Table core_measures(const TrialData& trial) {
  const MatchedReferences references = matched_references(trial);
  Table table{.title = "Core measures",
              .columns = {{.head = "Measure", .share = 2.95}, {.head = "Value", .share = 1.05, .is_number = true}},
              .rows = {}};
  table.columns.push_back({.head = "Unit", .share = 1.0});
  for (std::size_t column = 0; column < references.protocols.size(); ++column) {
    table.columns.push_back({.head = "Ref. " + std::to_string(column + 1), .share = 2.55, .is_number = true});
  }
  Cells cells(trial);
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    const auto measure = static_cast<Measure>(index);
    if (!info(measure).is_core) continue;
    Row row{.cells = {short_sentence(info(measure).sentence), cells.of(measure), std::string(info(measure).unit)}};
    for (const auto& protocol : references.protocols) row.cells.push_back(range_text(protocol, measure));
    table.rows.push_back(std::move(row));
  }
  table.footnotes = cells.footnotes();
  for (std::size_t column = 0; column < references.protocols.size(); ++column) {
    table.footnotes.push_back(footnote(references.protocols[column], column + 1));
  }
  if (references.protocols.empty()) return table;
  table.footnotes.emplace_back(
      "Other devices and programs give other values: a range shows the values of these people, not a target." +
      std::string(references.is_surface_assumed ? " The protocol does not state the surface: a firm surface is assumed." : ""));
  return table;
}

Table all_measures(const TrialData& trial) {
  Table table{.title = "All measures",
              .columns = {{.head = "Measure", .share = 4.6},
                          {.head = "Planar", .share = 1.4, .is_number = true},
                          {.head = "AP", .share = 1.4, .is_number = true},
                          {.head = "ML", .share = 1.4, .is_number = true},
                          {.head = "Unit", .share = 1.1}},
              .rows = {}};
  Cells cells(trial);
  for (const FamilyRow& family : kFamilies) {
    if (!family.first) {
      table.rows.push_back({.cells = {std::string(family.label)}, .is_heading = true});
      continue;
    }
    const auto member = [&](int offset) { return cells.of(static_cast<Measure>(static_cast<int>(*family.first) + offset)); };
    Row row{.cells = {std::string(family.label), "", "", "", std::string(info(*family.first).unit)}};
    if (family.shape != Shape::Pair) row.cells[1] = member(0);
    if (family.shape != Shape::Single) {
      row.cells[2] = member(family.shape == Shape::Triple ? 1 : 0);
      row.cells[3] = member(family.shape == Shape::Triple ? 2 : 1);
    }
    table.rows.push_back(std::move(row));
  }
  table.footnotes = cells.footnotes();
  return table;
}

std::vector<std::string> reference_warnings(const TrialData& trial) {
  if (!trial.analysis) return {};
  return warnings(matched_references(trial), *trial.analysis);
}

}  // namespace dts::report
