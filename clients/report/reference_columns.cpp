// SPDX-License-Identifier: Apache-2.0
#include "report/reference_columns.h"

#include <algorithm>
#include <cmath>

#include "report/number_text.h"

namespace dts::report {
namespace {

constexpr std::size_t kMostColumns = 3;
constexpr double kSameDurationS = 0.5;

constexpr int kMostDigits = 3;

/// Returns the number of decimals of `value`; at most two, as in the table of the sheet.
int decimals_of(double value) {
  int decimals = 0;
  for (double scale = 1.0; decimals < 2 && std::abs(value * scale - std::round(value * scale)) > 1e-9; scale *= 10.0) ++decimals;
  return decimals;
}

/// Formats three digits, but not more decimals than were published: additional zeros would suggest a precision that a range over people
/// does not have.
std::string published(double value, int most_decimals) {
  const int exponent = value > 0.0 ? static_cast<int>(std::floor(std::log10(value))) : 0;
  return fixed(value, std::clamp(kMostDigits - 1 - exponent, 0, most_decimals));
}

}  // namespace

MatchedReferences matched_references(const TrialData& trial) {
  const std::string eyes = trial.label("eyes");
  const std::string feet = trial.label("feet");
  const std::string surface = trial.label("surface");
  MatchedReferences matched{.protocols = {}, .is_surface_assumed = surface.empty()};
  // Whatever else a label names changes sway: feedback, a second task, the head, a stance in tandem.
  const auto is_of_ranges = [](const auto& label) { return label.first == "eyes" || label.first == "feet" || label.first == "surface"; };
  if (eyes.empty() || feet != "two" || !std::ranges::all_of(trial.recorded.labels, is_of_ranges)) return matched;
  for (const posturography::ReferenceProtocol& protocol : posturography::reference_protocols()) {
    if (protocol.eyes != eyes || protocol.surface != (surface.empty() ? "firm" : surface)) continue;
    if (matched.protocols.size() < kMostColumns) matched.protocols.push_back(protocol);
  }
  return matched;
}

std::string range_text(const posturography::ReferenceProtocol& protocol, posturography::Measure measure) {
  const auto range = posturography::reference_range(protocol, measure);
  if (!range) return "";
  const int decimals = std::max(decimals_of(range->low), decimals_of(range->high));
  return published(range->median, kMostDigits) + " (" + published(range->low, decimals) + "-" + published(range->high, decimals) + ")";
}

std::string footnote(const posturography::ReferenceProtocol& protocol, std::size_t number) {
  return "Ref. " + std::to_string(number) + ": median (5-95 % range) of " + std::string(protocol.people) + "; " +
         std::string(protocol.protocol) + "; " + std::string(protocol.source) + ".";
}

std::vector<std::string> warnings(const MatchedReferences& references, const posturography::Analysis& analysis) {
  std::vector<std::string> texts;
  if (references.protocols.empty()) return texts;
  for (const posturography::ReferenceProtocol& protocol : references.protocols) {
    if (std::abs(protocol.duration_s - analysis.duration_s) <= kSameDurationS) continue;
    texts.push_back("The reference ranges are from trials of " + fixed(protocol.duration_s, 0) + " s; this trial has " +
                    fixed(analysis.duration_s, 1) +
                    " s. Distances, ranges, areas and frequencies depend on the duration: do not compare them.");
    break;
  }
  const std::string profile(posturography::name(analysis.profile));
  for (const posturography::ReferenceProtocol& protocol : references.protocols) {
    if (protocol.protocol.find("profile " + profile) != std::string_view::npos) continue;
    texts.push_back("The reference ranges were computed with another filter than this trial (" + profile +
                    "). Path, velocity and measures derived from them depend on the filter.");
    break;
  }
  return texts;
}

}  // namespace dts::report
