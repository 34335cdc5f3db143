// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>

#include "core/join.h"
#include "core/number_text.h"
#include "session/json_object.h"
#include "session/sway_results.h"

namespace dts::session {
namespace {

using posturography::Measure;

/// The valid trials of one condition.
struct StandingCondition {
  std::string name;
  std::vector<std::pair<std::string, std::string>> labels;
  std::vector<const SwayTrialResult*> trials;

  [[nodiscard]] std::string label(const std::string& wanted) const {
    const auto found = std::ranges::find(labels, wanted, &std::pair<std::string, std::string>::first);
    return found == labels.end() ? "" : found->second;
  }
  /// "feet=two": all labels except eyes.
  [[nodiscard]] std::string stance() const {
    auto others = labels;
    std::erase_if(others, [](const auto& label) { return label.first == "eyes"; });
    std::ranges::sort(others);
    return core::join(others, ",", [](const auto& label) { return label.first + "=" + label.second; });
  }
};

bool is_cut(const SwayTrialResult* trial) { return trial->analysis->is_cut(); }

/// Values of different durations cannot be compared: leaves trials cut short by a gap out of the means, unless the condition has no
/// complete trial.
void leave_out_cut_trials(StandingCondition& condition) {
  if (!std::ranges::all_of(condition.trials, is_cut)) std::erase_if(condition.trials, is_cut);
}

std::vector<StandingCondition> by_condition(const std::vector<SwayTrialResult>& trials) {
  std::vector<StandingCondition> conditions;
  for (const SwayTrialResult& trial : trials) {
    if (!trial.analysis || !trial.analysis->is_valid()) continue;
    auto found = std::ranges::find(conditions, trial.condition, &StandingCondition::name);
    if (found == conditions.end()) found = conditions.insert(found, {.name = trial.condition, .labels = trial.labels, .trials = {}});
    found->trials.push_back(&trial);
  }
  for (StandingCondition& condition : conditions) leave_out_cut_trials(condition);
  return conditions;
}

/// Spread of one measure over the trials of a condition in which it is defined.
struct Spread {
  std::size_t count = 0;
  double mean = 0.0;
  double sd = 0.0;  ///< 1/(n - 1); 0 for one trial.
};

Spread spread_of(const StandingCondition& condition, Measure measure) {
  std::vector<double> values;
  for (const SwayTrialResult* trial : condition.trials) {
    if (const auto value = trial->analysis->measures.get(measure)) values.push_back(*value);
  }
  if (values.empty()) return {};
  Spread spread{.count = values.size(), .mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size())};
  double squares = 0.0;
  for (const double value : values) squares += (value - spread.mean) * (value - spread.mean);
  if (values.size() > 1) spread.sd = std::sqrt(squares / static_cast<double>(values.size() - 1));
  return spread;
}

/// The shortest and the longest trial may differ by one or two samples, but not by more.
constexpr double kSameDurationS = 0.1;

/// Returns the common duration of all trials; nothing if they differ.
std::optional<double> common_duration_s(const StandingCondition& condition) {
  const auto [shortest, longest] = std::ranges::minmax(condition.trials, {}, [](const auto* trial) { return trial->analysis->duration_s; });
  if (longest->analysis->duration_s - shortest->analysis->duration_s > kSameDurationS) return std::nullopt;
  return shortest->analysis->duration_s;
}

std::vector<Measure> core_measures() {
  std::vector<Measure> measures;
  for (std::size_t index = 0; index < posturography::kMeasureCount; ++index) {
    if (posturography::info(static_cast<Measure>(index)).is_core) measures.push_back(static_cast<Measure>(index));
  }
  return measures;
}

void add_means(const StandingCondition& condition, std::vector<SessionFigure>& summary) {
  const auto duration_s = common_duration_s(condition);
  for (const Measure measure : core_measures()) {
    const Spread spread = spread_of(condition, measure);
    if (spread.count == 0) continue;
    JsonObject details;
    details.add("trials", spread.count);
    if (spread.count > 1) details.add("sd", spread.sd);
    details.add("profile", std::string(posturography::name(condition.trials.front()->analysis->profile)));
    details.add("rate_hz", condition.trials.front()->analysis->rate_hz);
    details.add("duration_s", duration_s);
    const posturography::MeasureInfo& about = posturography::info(measure);
    summary.push_back({.name = condition.name + "/" + std::string(about.symbol),
                       .value = spread.mean,
                       .unit = std::string(about.unit),
                       .details = details.text()});
  }
}

/// Returns an empty text if all trials of both conditions are equally long.
std::string why_durations_differ(const StandingCondition& open, const StandingCondition& closed) {
  const auto open_s = common_duration_s(open);
  const auto closed_s = common_duration_s(closed);
  if (!open_s) return "the trials with eyes open are not equally long";
  if (!closed_s) return "the trials with eyes closed are not equally long";
  if (std::abs(*open_s - *closed_s) <= kSameDurationS) return "";
  const auto tenths = [](double time_s) { return core::number_text(std::round(10.0 * time_s) / 10.0) + " s"; };
  return "the trials with eyes open last " + tenths(*open_s) + ", those with eyes closed " + tenths(*closed_s);
}

/// Eyes closed divided by eyes open, only for equal stance, surface and duration (posturography sheet section 6).
void add_romberg(const StandingCondition& open, const StandingCondition& closed, std::vector<SessionFigure>& summary) {
  if (!why_durations_differ(open, closed).empty()) return;
  const auto open_s = common_duration_s(open);
  for (const Measure measure : core_measures()) {
    const posturography::MeasureInfo& about = posturography::info(measure);
    const Spread with = spread_of(open, measure);
    const Spread without = spread_of(closed, measure);
    if (!about.is_ratio_scaled || with.count == 0 || without.count == 0) continue;
    const double quotient = without.mean / with.mean;
    if (!std::isfinite(quotient)) continue;  // also skips 0 / 0
    JsonObject details;
    details.add("open", with.mean);
    details.add("closed", without.mean);
    details.add("open_trials", with.count);
    details.add("closed_trials", without.count);
    details.add("duration_s", *open_s);
    const std::string stance = open.stance();
    summary.push_back({.name = "romberg/" + (stance.empty() ? "" : stance + "/") + std::string(about.symbol),
                       .value = quotient,
                       .unit = "1",
                       .details = details.text()});
  }
}

/// Returns nullptr if there is none, or if there are several: it would be unclear which one the quotient refers to.
const StandingCondition* only_one(const std::vector<StandingCondition>& conditions, const std::string& eyes, const std::string& stance) {
  const auto is_wanted = [&](const StandingCondition& condition) {
    return condition.label("eyes") == eyes && condition.stance() == stance;
  };
  const auto found = std::ranges::find_if(conditions, is_wanted);
  return std::ranges::count_if(conditions, is_wanted) == 1 ? &*found : nullptr;
}

std::string why_not_one(const std::vector<StandingCondition>& conditions, const std::string& eyes, const std::string& stance) {
  const bool is_there = std::ranges::any_of(
      conditions, [&](const StandingCondition& condition) { return condition.label("eyes") == eyes && condition.stance() == stance; });
  return is_there ? "there are several conditions with eyes " + eyes : "no trial with eyes " + eyes + " counts";
}

}  // namespace

std::vector<MissingQuotient> missing_quotients(const std::vector<SwayTrialResult>& trials) {
  std::map<std::string, std::set<std::string>> eyes_by_stance;
  for (const SwayTrialResult& trial : trials) {
    const StandingCondition condition{.name = trial.condition, .labels = trial.labels, .trials = {}};
    eyes_by_stance[condition.stance()].insert(condition.label("eyes"));
  }
  const std::vector<StandingCondition> conditions = by_condition(trials);
  std::vector<MissingQuotient> missing;
  for (const auto& [stance, eyes] : eyes_by_stance) {
    if (!eyes.contains("open") || !eyes.contains("closed")) continue;
    const StandingCondition* const open = only_one(conditions, "open", stance);
    const StandingCondition* const closed = only_one(conditions, "closed", stance);
    const std::string reason = open == nullptr     ? why_not_one(conditions, "open", stance)
                               : closed == nullptr ? why_not_one(conditions, "closed", stance)
                                                   : why_durations_differ(*open, *closed);
    if (!reason.empty()) missing.push_back({stance, reason});
  }
  return missing;
}

std::vector<SessionFigure> sway_summary(const std::vector<SwayTrialResult>& trials) {
  const std::vector<StandingCondition> conditions = by_condition(trials);
  std::vector<SessionFigure> summary;
  for (const StandingCondition& condition : conditions) add_means(condition, summary);
  for (const StandingCondition& open : conditions) {
    if (open.label("eyes") != "open" || only_one(conditions, "open", open.stance()) == nullptr) continue;
    const StandingCondition* const closed = only_one(conditions, "closed", open.stance());
    if (closed != nullptr) add_romberg(open, *closed, summary);
  }
  return summary;
}

}  // namespace dts::session
