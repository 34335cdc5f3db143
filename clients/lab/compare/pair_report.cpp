// SPDX-License-Identifier: Apache-2.0
#include "lab/compare/pair_report.h"

#include <cmath>
#include <utility>

#include "lab/compare/compare_view.h"
#include "lab/compare/pair_pictures.h"
#include "report/number_text.h"
#include "report/page_parts.h"

namespace dts::lab::compare {
namespace {

using report::fixed;

std::string plus_minus(double value, double deviation, int decimals, const std::string& unit) {
  if (!std::isfinite(value)) return "unknown";
  return fixed(value, decimals) + " \u00b1 " + fixed(deviation, decimals) + " " + unit;
}

std::string delay_text(double delay_s) { return fixed(1e3 * delay_s, 1) + " ms"; }

std::vector<report::Fact> facts_of(const Comparison& comparison, const PairNames& names) {
  const Alignment& alignment = comparison.alignment;
  std::vector<report::Fact> facts;
  if (!names.session.empty()) facts.push_back({.name = "Session", .value = names.session});
  facts.push_back({.name = "A", .value = names.a});
  facts.push_back({.name = "B", .value = names.b});
  facts.push_back({.name = "Aligned by", .value = std::string(name(alignment.means))});
  facts.push_back({.name = "Offset", .value = plus_minus(alignment.offset_s, alignment.offset_sd_s, 4, "s")});
  if (!alignment.pieces.empty()) facts.push_back({.name = "Jumps of a clock", .value = pieces_text(alignment)});
  if (alignment.is_refined_by_signals) facts.push_back({.name = "Refined by", .value = "the signals"});
  facts.push_back({.name = "Drift", .value = plus_minus(alignment.drift_ppm, alignment.drift_sd_ppm, 1, "ppm")});
  facts.push_back({.name = "SD at the ends", .value = fixed(1e3 * comparison.end_sd_s, 1) + " ms"});
  facts.push_back({.name = "Filter delays", .value = "A " + delay_text(comparison.delay_a_s) + ", B " + delay_text(comparison.delay_b_s)});
  facts.push_back(
      {.name = "Compared", .value = std::to_string(comparison.scan_count) + " scans over " + fixed(comparison.overlap_s, 2) + " s"});
  return facts;
}

report::Table differences_of(const Comparison& comparison) {
  report::Table table{.title = "Difference of the centres of pressure, mm",
                      .columns = {{.head = "", .share = 2.2},
                                  {.head = "ML (x)", .is_number = true},
                                  {.head = "AP (y)", .is_number = true},
                                  {.head = "both", .is_number = true}},
                      .rows = {}};
  const AxisDifference& x = comparison.x;
  const AxisDifference& y = comparison.y;
  const auto add = [&](const std::string& what, double of_x, double of_y, double of_both, int decimals) {
    const std::string both = std::isfinite(of_both) ? fixed(of_both, decimals) : "";
    table.rows.push_back({.cells = {what, fixed(of_x, decimals), fixed(of_y, decimals), both}});
  };
  const double none = std::nan("");
  add("Bias, B - A", x.mean_difference_mm, y.mean_difference_mm, none, 3);
  add("Lower limit of agreement", x.lower_limit_mm, y.lower_limit_mm, none, 3);
  add("Upper limit of agreement", x.upper_limit_mm, y.upper_limit_mm, none, 3);
  add("RMSE, as recorded", x.rmse_mm, y.rmse_mm, comparison.rmse_total_mm, 3);
  add("RMSE, means removed", x.rmse_mean_removed_mm, y.rmse_mean_removed_mm, comparison.rmse_total_mean_removed_mm, 3);
  add("Largest, as recorded", x.largest_mm, y.largest_mm, none, 3);
  add("Largest, means removed", x.largest_mean_removed_mm, y.largest_mean_removed_mm, none, 3);
  add("Correlation (no unit)", x.correlation, y.correlation, comparison.correlation, 4);
  table.footnotes.emplace_back(
      "Limits of agreement: bias \u00b1 1.96 standard deviations of the differences of scans. Neighbouring scans are alike, so the limits "
      "describe this recording and are no confidence interval.");
  return table;
}

std::string means_text(const Alignment& alignment) {
  switch (alignment.means) {
    case Alignment::Means::PulseTrain:
      return "by " + std::to_string(alignment.event_count) + " common pulses of a synchronisation signal, one per " +
             fixed(alignment.period_s, 2) + " s (robust least squares in offset and drift)";
    case Alignment::Means::Trigger: return "by " + std::to_string(alignment.event_count) + " common trigger edges";
    case Alignment::Means::Marker: return "by " + std::to_string(alignment.event_count) + " common markers";
    case Alignment::Means::Correlation:
      return alignment.window_count > 0 ? "by the signals in " + std::to_string(alignment.window_count) +
                                              " windows (cross-correlation and least squares; a robust line gives offset and drift)"
                                        : "by the signals (cross-correlation and least squares in offset and drift)";
  }
  return "";
}

report::Notes methods_of(const Comparison& comparison, const PairNames& names) {
  const Alignment& alignment = comparison.alignment;
  std::string text = "The centre of pressure was recorded by two instruments (A: " + names.a + ", B: " + names.b +
                     ") with clocks of their own. The clocks were aligned " + means_text(alignment) +
                     ". The offset has a standard error of " + fixed(1e3 * alignment.offset_sd_s, 2) + " ms";
  if (alignment.is_refined_by_signals) text += "; the signals refined it";
  if (std::isfinite(alignment.drift_ppm)) {
    text += ", the drift was " + plus_minus(alignment.drift_ppm, alignment.drift_sd_ppm, 1, "ppm");
    if (alignment.is_drift_by_signals) text += " (from the signals)";
  }
  if (!alignment.pieces.empty()) {
    text += ". A clock jumped at gaps, so each piece has an offset of its own (" + pieces_text(alignment) + ")";
  }
  text +=
      ". Known delays of the filters were removed first. The recording with the higher rate was interpolated (cubic Hermite) at the scans "
      "of "
      "the other. Agreement is described as in Bland and Altman (1986). Computed with "
      "dtslab " DTS_VERSION ".";
  return {.title = "Methods, for a paper",
          .items = {std::move(text),
                    "Bland JM, Altman DG. Statistical methods for assessing agreement between two methods of clinical measurement. Lancet "
                    "1986; 327: 307-310."}};
}

std::vector<report::Section> pictures_of(const Comparison& comparison, const PairNames& names) {
  const Paired& paired = comparison.paired;
  const PairAxis ml{.name = "ML (x)", .a_mm = paired.a_x, .b_mm = paired.b_x, .difference = comparison.x};
  const PairAxis ap{.name = "AP (y)", .a_mm = paired.a_y, .b_mm = paired.b_y, .difference = comparison.y};
  return {{.columns = {{overlay_figure(paired, ml, names.a, names.b), overlay_figure(paired, ap, names.a, names.b)}}},
          {.columns = {{agreement_figure(ml)}, {agreement_figure(ap)}}}};
}

report::PageContent content_of(const Comparison& comparison, const PairNames& names) {
  std::vector<std::string> alerts;
  if (comparison.is_simulated) alerts.emplace_back("Synthetic data from a simulator. No person was measured.");
  for (const std::string& warning : warnings_of(comparison)) alerts.push_back("Note: " + warning + ".");
  return {.title = "Two centres of pressure",
          .subtitle = names.a + " and " + names.b,
          .facts = facts_of(comparison, names),
          .alerts = std::move(alerts),
          .sections = {}};
}

}  // namespace

std::string pair_report_html(const Comparison& comparison, const PairNames& names) {
  report::PageContent content = content_of(comparison, names);
  content.sections.push_back({.columns = {{differences_of(comparison)}, {methods_of(comparison, names)}}});
  for (report::Section& section : pictures_of(comparison, names)) content.sections.push_back(std::move(section));
  return report::html_of(content);
}

std::string pair_pictures_svg(const Comparison& comparison, const PairNames& names) {
  report::PageContent content = content_of(comparison, names);
  content.sections = pictures_of(comparison, names);
  return report::svg_of(content);
}

}  // namespace dts::lab::compare
