// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/compare_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "cli/table.h"

namespace dts::lab::compare {
namespace {

using cli::decimal;

constexpr std::size_t kMostFaultsNamed = 5;

cli::Json to_json(const AxisDifference& axis) {
  cli::Json json = cli::Json::object();
  cli::set_number(json, "rmse_mm", axis.rmse_mm);
  cli::set_number(json, "rmse_mean_removed_mm", axis.rmse_mean_removed_mm);
  cli::set_number(json, "mean_difference_mm", axis.mean_difference_mm);
  json["limits_of_agreement_mm"] = {axis.lower_limit_mm, axis.upper_limit_mm};
  cli::set_number(json, "largest_mm", axis.largest_mm);
  cli::set_number(json, "largest_mean_removed_mm", axis.largest_mean_removed_mm);
  cli::set_number(json, "correlation", axis.correlation);
  return json;
}

/// "B lost the pulse"
std::string fault_text(PulseFault::Kind kind) {
  switch (kind) {
    case PulseFault::Kind::LostInA: return "A lost the pulse";
    case PulseFault::Kind::LostInB: return "B lost the pulse";
    case PulseFault::Kind::ExtraInA: return "A has an extra pulse";
    case PulseFault::Kind::ExtraInB: return "B has an extra pulse";
  }
  return "";
}

cli::Json faults_json(const std::vector<PulseFault>& faults) {
  cli::Json list = cli::Json::array();
  for (const PulseFault& fault : faults) {
    const bool is_in_a = fault.kind == PulseFault::Kind::LostInA || fault.kind == PulseFault::Kind::ExtraInA;
    const bool is_lost = fault.kind == PulseFault::Kind::LostInA || fault.kind == PulseFault::Kind::LostInB;
    list.push_back({{"recording", is_in_a ? "A" : "B"}, {"fault", is_lost ? "lost" : "extra"}, {"time_s", fault.time_s}});
  }
  return list;
}

cli::Json pieces_json(const std::vector<Alignment::Piece>& pieces) {
  cli::Json list = cli::Json::array();
  for (const Alignment::Piece& piece : pieces) {
    cli::Json json = cli::Json::object();
    cli::set_number(json, "from_s", piece.from_s);
    cli::set_number(json, "shift_s", piece.shift_s);
    cli::set_number(json, "shift_sd_s", piece.shift_sd_s);
    list.push_back(json);
  }
  return list;
}

cli::Json alignment_json(const Comparison& comparison) {
  const Alignment& alignment = comparison.alignment;
  cli::Json json{{"by", name(alignment.means)}};
  cli::set_number(json, "offset_s", alignment.offset_s);
  cli::set_number(json, "offset_sd_s", alignment.offset_sd_s);
  cli::set_number(json, "drift_ppm", alignment.drift_ppm);
  cli::set_number(json, "drift_sd_ppm", alignment.drift_sd_ppm);
  cli::set_number(json, "reference_s", alignment.reference_s);
  cli::set_number(json, "end_sd_s", comparison.end_sd_s);
  cli::set_number(json, "peak_correlation", alignment.peak_correlation);
  if (!alignment.warning.empty()) json["warning"] = alignment.warning;
  if (alignment.event_count > 0) json["events"] = alignment.event_count;
  if (alignment.window_count > 0) json["windows"] = alignment.window_count;
  if (!alignment.pieces.empty()) json["pieces"] = pieces_json(alignment.pieces);
  if (alignment.means == Alignment::Means::PulseTrain) {
    cli::set_number(json, "period_s", alignment.period_s);
    json["faults"] = faults_json(alignment.faults);
  }
  cli::set_number(json, "filter_delay_a_s", comparison.delay_a_s);
  cli::set_number(json, "filter_delay_b_s", comparison.delay_b_s);
  return json;
}

std::string with_deviation(double value, double deviation, int decimals, const std::string& unit) {
  return decimal(value, decimals) + " +- " + decimal(deviation, decimals) + " " + unit;
}

std::string basis_of(const Alignment& alignment) {
  if (alignment.window_count > 0) return " (" + std::to_string(alignment.window_count) + " windows)";
  if (alignment.event_count == 0) return "";
  if (alignment.means == Alignment::Means::PulseTrain) {
    return " (" + std::to_string(alignment.event_count) + " pulses, one per " + decimal(alignment.period_s, 3) + " s)";
  }
  return " (" + std::to_string(alignment.event_count) + (alignment.event_count == 1 ? " event)" : " events)");
}

}  // namespace

cli::Json to_json(const Comparison& comparison) {
  cli::Json json{{"alignment", alignment_json(comparison)}, {"overlap_s", comparison.overlap_s}, {"scans", comparison.scan_count}};
  cli::set_number(json, "correlation", comparison.correlation);
  json["x"] = to_json(comparison.x);
  json["y"] = to_json(comparison.y);
  cli::set_number(json, "rmse_total_mm", comparison.rmse_total_mm);
  cli::set_number(json, "rmse_total_mean_removed_mm", comparison.rmse_total_mean_removed_mm);
  return json;
}

std::string pieces_text(const Alignment& alignment) {
  double least_s = std::numeric_limits<double>::infinity();
  double most_s = -least_s;
  for (const Alignment::Piece& piece : alignment.pieces) {
    if (!std::isfinite(piece.shift_s)) continue;
    least_s = std::min(least_s, alignment.offset_s + piece.shift_s);
    most_s = std::max(most_s, alignment.offset_s + piece.shift_s);
  }
  return std::to_string(alignment.pieces.size()) + " pieces, offsets from " + decimal(least_s, 4) + " to " + decimal(most_s, 4) + " s";
}

std::string alignment_text(const Comparison& comparison) {
  const Alignment& alignment = comparison.alignment;
  std::string text = "aligned by " + std::string(name(alignment.means)) + basis_of(alignment) + ": add " +
                     with_deviation(alignment.offset_s, alignment.offset_sd_s, 4, "s") + " to the times of B";
  std::string more;
  if (!alignment.pieces.empty()) more += "; " + pieces_text(alignment);
  if (alignment.is_refined_by_signals) more += "; the signals refined the offset";
  if (alignment.is_drift_by_signals) more += "; the drift is from the signals";
  if (!std::isfinite(alignment.drift_ppm)) return text + ", drift unknown" + more;
  return text + ", whose clock is " + with_deviation(std::abs(alignment.drift_ppm), alignment.drift_sd_ppm, 1, "ppm") +
         (alignment.drift_ppm < 0.0 ? " fast" : " slow") + "; at the ends: +- " + decimal(1e3 * comparison.end_sd_s, 1) + " ms" + more;
}

std::vector<std::string> warnings_of(const Comparison& comparison) {
  const Alignment& alignment = comparison.alignment;
  std::vector<std::string> warnings;
  if (!alignment.warning.empty()) warnings.push_back(alignment.warning);
  for (std::size_t k = 0; k < std::min(alignment.faults.size(), kMostFaultsNamed); ++k) {
    warnings.push_back(fault_text(alignment.faults[k].kind) + " at " + decimal(alignment.faults[k].time_s, 3) + " s of A");
  }
  if (alignment.faults.size() > kMostFaultsNamed) {
    warnings.push_back(std::to_string(alignment.faults.size() - kMostFaultsNamed) + " more pulses are lost or extra: see --json");
  }
  for (std::size_t k = 0; k < alignment.pieces.size(); ++k) {
    if (std::isfinite(alignment.pieces[k].shift_s)) continue;
    const std::string from = k == 0 ? "the first stretch" : "the stretch from " + decimal(alignment.pieces[k].from_s, 3) + " s of B";
    warnings.push_back("nothing aligns " + from + ", up to the next gap: it is not compared");
  }
  const bool is_opposed = comparison.x.correlation < 0.0 || comparison.y.correlation < 0.0;
  if (comparison.correlation > kLeastCorrelation && !is_opposed) return warnings;
  warnings.push_back("the recordings do not agree: correlation " + decimal(comparison.correlation, 2) + " (x " +
                     decimal(comparison.x.correlation, 2) + ", y " + decimal(comparison.y.correlation, 2) +
                     "); check that the axes are the same and that both are of the same trial");
  return warnings;
}

void print(const Comparison& comparison, cli::Console& console) {
  console.out << alignment_text(comparison) << "\ncompared: " << comparison.scan_count << " scans over " << decimal(comparison.overlap_s, 2)
              << " s\n\n";
  cli::Table table({"AXIS", ">RMSE (mm)", ">MEAN REMOVED (mm)", ">B - A (mm)", ">LIMITS OF AGREEMENT (mm)", ">LARGEST (mm)",
                    ">MEAN REMOVED (mm)", ">CORRELATION"});
  const auto add = [&](const char* axis, const AxisDifference& of) {
    table.add({{axis},
               {decimal(of.rmse_mm, 3)},
               {decimal(of.rmse_mean_removed_mm, 3)},
               {decimal(of.mean_difference_mm, 3)},
               {decimal(of.lower_limit_mm, 3) + " .. " + decimal(of.upper_limit_mm, 3)},
               {decimal(of.largest_mm, 3)},
               {decimal(of.largest_mean_removed_mm, 3)},
               {decimal(of.correlation, 4)}});
  };
  add("x", comparison.x);
  add("y", comparison.y);
  table.add({{"both"}, {decimal(comparison.rmse_total_mm, 3)}, {decimal(comparison.rmse_total_mean_removed_mm, 3)}});
  table.print(console);
}

}  // namespace dts::lab::compare
