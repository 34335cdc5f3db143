// SPDX-License-Identifier: Apache-2.0
#include "session/reach_summary.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/join.h"
#include "session/json_object.h"

namespace dts::session {
namespace {

using core::TrunkClass;

constexpr double kFingertipsPerArm = 1.15;
/// Slightly above 1.2, because targets are placed to the millimetre.
constexpr double kFarthestBoundaryPerArm = 1.205;

/// Mean and spread of the added values.
class Sample {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::optional<double> mean() const { return count_ > 0 ? std::optional(mean_) : std::nullopt; }
  [[nodiscard]] std::optional<double> deviation() const {
    return count_ > 1 ? std::optional(std::sqrt(squares_ / static_cast<double>(count_ - 1))) : std::nullopt;
  }
  [[nodiscard]] double squares() const { return squares_; }

 private:
  std::size_t count_ = 0;
  double mean_ = 0.0;
  double squares_ = 0.0;  ///< Sum of squared deviations from the mean (Welford 1962).
};

struct Counts {
  std::size_t trials = 0;
  std::size_t gaps = 0;
  std::size_t found = 0;
  std::size_t classified = 0;             ///< Has a class, Rejected included.
  std::array<std::size_t, 5> of_class{};  ///< From Rejected to Maximum.
  std::size_t agreed = 0;
  std::size_t compared = 0;

  [[nodiscard]] std::size_t of(TrunkClass trunk_class) const {
    return of_class[static_cast<std::size_t>(static_cast<int>(trunk_class) + 1)];
  }
};

struct Target {
  std::string condition;
  std::optional<double> target_cm;
  std::optional<TrunkClass> expected;
  Counts counts;
  Sample d2_mm;
  Sample trunk_deg;
  std::size_t on_own_scale = 0;  ///< Of the angles.
  Sample sparc;
};

bool has_sound_angle(const core::TrunkMovement& movement) {
  namespace reason = core::class_reason;
  const bool is_doubtful = (movement.reasons & (reason::kBadReach | reason::kOutOfRange | reason::kDisagreement)) != 0;
  return !(movement.trunk_class == TrunkClass::Rejected && is_doubtful);
}

bool is_known(TrunkClass trunk_class) { return trunk_class >= TrunkClass::Rejected && trunk_class <= TrunkClass::Maximum; }

void count_class(Counts& counts, const ReachTrialResult& result) {
  const bool is_classified = result.movement && is_known(result.movement->trunk_class);
  if (is_classified) {
    ++counts.classified;
    ++counts.of_class[static_cast<std::size_t>(static_cast<int>(result.movement->trunk_class) + 1)];
  }
  if (!result.expected || result.has_gap) return;
  const bool is_still = !result.reach && *result.expected == TrunkClass::None;  // the arm alone hardly moves the seat
  const bool has_class = is_classified && result.movement->trunk_class != TrunkClass::Rejected;
  if (!is_still && !has_class) return;
  ++counts.compared;
  if (is_still || result.movement->trunk_class == *result.expected) ++counts.agreed;
}

void add(Target& target, const ReachTrialResult& result) {
  ++target.counts.trials;
  if (result.has_gap) ++target.counts.gaps;
  count_class(target.counts, result);
  if (!result.reach) return;
  ++target.counts.found;
  target.d2_mm.add(result.reach->features.d2_mm());
  target.sparc.add(result.reach->features.smoothness);
  if (!result.movement || !has_sound_angle(*result.movement) || !std::isfinite(result.movement->trunk_deg)) return;
  target.trunk_deg.add(result.movement->trunk_deg);
  if ((result.movement->reasons & core::class_reason::kCalibrated) != 0) ++target.on_own_scale;
}

/// Groups the results by target, in the order in which the targets first occur, so that the result is reproducible.
std::vector<Target> by_target(std::span<const ReachTrialResult> results) {
  std::map<std::pair<std::string, std::optional<double>>, std::size_t> places;
  std::vector<Target> targets;
  for (const ReachTrialResult& result : results) {
    const auto [place, is_new] = places.try_emplace({result.condition, result.target_cm}, targets.size());
    if (is_new) targets.push_back({.condition = result.condition, .target_cm = result.target_cm, .expected = result.expected});
    add(targets[place->second], result);
  }
  return targets;
}

Counts total(const std::vector<Target>& targets) {
  Counts sum;
  for (const Target& target : targets) {
    sum.trials += target.counts.trials;
    sum.gaps += target.counts.gaps;
    sum.found += target.counts.found;
    sum.classified += target.counts.classified;
    sum.agreed += target.counts.agreed;
    sum.compared += target.counts.compared;
    for (std::size_t k = 0; k < sum.of_class.size(); ++k) sum.of_class[k] += target.counts.of_class[k];
  }
  return sum;
}

/// Returns the root of the mean variance within a target, weighted by degrees of freedom.
std::optional<double> pooled_deviation(const std::vector<Target>& targets, Sample Target::*sample) {
  double squares = 0.0;
  std::size_t freedom = 0;
  for (const Target& target : targets) {
    const Sample& one = target.*sample;
    if (one.count() < 2) continue;
    squares += one.squares();
    freedom += one.count() - 1;
  }
  return freedom > 0 ? std::optional(std::sqrt(squares / static_cast<double>(freedom))) : std::nullopt;
}

const Target* at_critical_boundary(const std::vector<Target>& targets, const physics::Person& person) {
  const Target* nearest = nullptr;
  double nearest_off = 0.0;
  for (const Target& target : targets) {
    if (!target.target_cm) continue;
    const double arms = *target.target_cm / person.arm_length_cm;
    const double off = std::abs(arms - kFingertipsPerArm);
    if (!(arms <= kFarthestBoundaryPerArm) || (nearest != nullptr && off >= nearest_off)) continue;
    nearest = &target;
    nearest_off = off;
  }
  return nearest;
}

std::string json_of(const Target& target) {
  JsonObject classes;
  classes.add("none", target.counts.of(TrunkClass::None));
  classes.add("minor", target.counts.of(TrunkClass::Minor));
  classes.add("moderate", target.counts.of(TrunkClass::Moderate));
  classes.add("maximum", target.counts.of(TrunkClass::Maximum));
  classes.add("rejected", target.counts.of(TrunkClass::Rejected));
  JsonObject json;
  json.add("condition", target.condition);
  json.add("target_cm", target.target_cm);
  if (target.expected) json.add("expected_class", static_cast<double>(*target.expected));
  json.add("trials", target.counts.trials);
  json.add("with_gap", target.counts.gaps);
  json.add("reaches_detected", target.counts.found);
  json.add_json("classes", classes.text());
  json.add("agreed", target.counts.agreed);
  json.add("compared", target.counts.compared);
  json.add("d2_mean_mm", target.d2_mm.mean());
  json.add("d2_sd_mm", target.d2_mm.deviation());
  json.add("angles", target.trunk_deg.count());
  json.add("angles_on_own_scale", target.on_own_scale);
  json.add("trunk_mean_deg", target.trunk_deg.mean());
  json.add("trunk_sd_deg", target.trunk_deg.deviation());
  json.add("sparc_mean", target.sparc.mean());
  json.add("sparc_sd", target.sparc.deviation());
  return json.text();
}

SessionFigure share(const std::string& name, std::size_t part, const char* part_name, std::size_t whole, const char* whole_name) {
  JsonObject details;
  details.add(part_name, part);
  details.add(whole_name, whole);
  return {.name = name, .value = static_cast<double>(part) / static_cast<double>(whole), .unit = "1", .details = details.text()};
}

void add_shares(const Counts& all, std::vector<SessionFigure>& summary) {
  summary.push_back({.name = "trials", .value = static_cast<double>(all.trials), .unit = "1", .details = {}});
  if (all.trials > all.gaps) {
    summary.push_back(share("reaches_detected_share", all.found, "detected", all.trials - all.gaps, "trials_without_gap"));
  }
  if (all.classified > 0)
    summary.push_back(share("rejected_share", all.of(TrunkClass::Rejected), "rejected", all.classified, "classified"));
  if (all.compared > 0) summary.push_back(share("class_agreement_share", all.agreed, "agreed", all.compared, "compared"));
}

void add_critical_boundary(const std::vector<Target>& targets, const std::optional<physics::Person>& person,
                           std::vector<SessionFigure>& summary) {
  const Target* target = person ? at_critical_boundary(targets, *person) : nullptr;
  if (target == nullptr || !target->trunk_deg.mean()) return;
  JsonObject details;
  details.add("condition", target->condition);
  details.add("target_cm", target->target_cm);
  details.add("arm_lengths", *target->target_cm / person->arm_length_cm);
  details.add("trials", target->counts.trials);
  details.add("angles", target->trunk_deg.count());
  details.add("sd_deg", target->trunk_deg.deviation());
  summary.push_back(
      {.name = "trunk_at_critical_boundary_deg", .value = *target->trunk_deg.mean(), .unit = "deg", .details = details.text()});
}

}  // namespace

std::vector<TargetSummary> summarize_targets(std::span<const ReachTrialResult> results) {
  const auto spread = [](const Sample& sample) {
    return Spread{.count = sample.count(), .mean = sample.mean(), .deviation = sample.deviation()};
  };
  std::vector<TargetSummary> summaries;
  for (const Target& target : by_target(results)) {
    summaries.push_back({.condition = target.condition,
                         .target_cm = target.target_cm,
                         .expected = target.expected,
                         .trials = target.counts.trials,
                         .gaps = target.counts.gaps,
                         .found = target.counts.found,
                         .of_class = target.counts.of_class,
                         .agreed = target.counts.agreed,
                         .compared = target.counts.compared,
                         .d2_mm = spread(target.d2_mm),
                         .trunk_deg = spread(target.trunk_deg),
                         .sparc = spread(target.sparc)});
  }
  return summaries;
}

std::vector<SessionFigure> summarize(std::span<const ReachTrialResult> results, const std::optional<physics::Person>& person) {
  std::vector<SessionFigure> summary;
  if (results.empty()) return summary;
  const std::vector<Target> targets = by_target(results);
  add_shares(total(targets), summary);
  add_critical_boundary(targets, person, summary);
  if (const auto spread = pooled_deviation(targets, &Target::trunk_deg)) summary.push_back({"trunk_sd_deg", *spread, "deg", {}});
  if (const auto spread = pooled_deviation(targets, &Target::d2_mm)) summary.push_back({"d2_sd_mm", *spread, "mm", {}});
  Sample sparc;
  for (const ReachTrialResult& result : results) {
    if (result.reach) sparc.add(result.reach->features.smoothness);
  }
  if (sparc.mean()) summary.push_back({"sparc_mean", *sparc.mean(), "1", {}});
  JsonObject details;
  details.add_json("targets", "[" + core::join(targets, ",", json_of) + "]");
  summary.push_back({"targets", static_cast<double>(targets.size()), "1", details.text()});
  return summary;
}

}  // namespace dts::session
