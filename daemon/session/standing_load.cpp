// SPDX-License-Identifier: Apache-2.0
#include "session/standing_load.h"

#include <algorithm>
#include <cmath>

#include "core/number_text.h"
#include "physics/body/two_link.h"
#include "physics/cop/two_feet.h"
#include "session/json_object.h"
#include "session/trial_stance.h"

namespace dts::session {
namespace {

bool is_on_one_foot(const SwayTrialResult& trial) {
  return std::ranges::find(trial.labels, std::pair<std::string, std::string>("feet", "one")) != trial.labels.end();
}

/// Returns the value rounded to a multiple of 1 / `per_unit`.
std::string rounded(double value, double per_unit) { return core::number_text(std::round(value * per_unit) / per_unit); }

}  // namespace

std::optional<double> mean_load_n(const posturography::CopSeries& cop) {
  double sum_n = 0.0;
  std::size_t count = 0;
  for (const double load_n : cop.load_n) {
    if (!std::isfinite(load_n)) continue;
    sum_n += load_n;
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(sum_n / static_cast<double>(count));
}

double StandingLoad::mass_kg() const noexcept { return mean_n / physics::kGravityMPerS2; }

bool StandingLoad::is_doubtful() const noexcept { return stated_kg && physics::is_load_doubtful(mass_kg(), *stated_kg); }

std::string StandingLoad::sentence() const {
  const bool has_width = stance_width_mm > 0.0;
  std::string text = has_width ? rounded(mass_kg(), 10.0) + " kg, corrected for two feet with the stated stance width of " +
                                     rounded(stance_width_mm, 1.0) + " mm"
                               : "about " + rounded(mass_kg(), 1.0) + " kg, corrected for two feet without a stance width";
  if (is_doubtful()) {
    text += std::string("; stated ") + (has_width ? "width or " : "") + "weight is doubtful: " + rounded(*stated_kg, 10.0) + " kg";
  }
  return text;
}

std::optional<StandingLoad> standing_load(const std::vector<SwayTrialResult>& trials,
                                          const std::vector<std::pair<std::string, std::string>>& fields) {
  StandingLoad load{.stance_width_mm = stance_width_mm(fields), .stated_kg = field_number(fields, "weight_kg")};
  for (const SwayTrialResult& trial : trials) {
    if (!trial.mean_load_n || !trial.analysis || !trial.analysis->is_valid() || is_on_one_foot(trial)) continue;
    load.mean_n += *trial.mean_load_n;
    ++load.trials;
  }
  if (load.trials == 0) return std::nullopt;
  load.mean_n /= static_cast<double>(load.trials);
  return load;
}

SessionFigure to_figure(const StandingLoad& load) {
  JsonObject details;
  details.add("trials", load.trials);
  if (load.stance_width_mm > 0.0) details.add("stance_width_mm", load.stance_width_mm);
  if (load.is_doubtful()) details.add("stated_weight_kg", load.stated_kg);
  details.add("note", load.sentence());
  return {.name = "load_n", .value = load.mean_n, .unit = "N", .details = details.text()};
}

}  // namespace dts::session
