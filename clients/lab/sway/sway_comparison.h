// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/sway/measured_trial.h"

namespace dts::lab::steadiness {

/// A core measure of two trials.
struct ComparedMeasure {
  posturography::Measure measure{};
  double first = 0.0;
  double second = 0.0;
  std::optional<double> percent;  ///< Second less first, of first; of ratio-scaled measures above 0 only.
  std::optional<double> romberg;  ///< Eyes closed / eyes open.
};

/// Two trials side by side.
struct Comparison {
  std::vector<ComparedMeasure> measures;  ///< That both have.
  bool has_romberg = false;
  std::vector<std::string> warnings;  ///< Why the trials do not compare well: never silently.
};

/// Both have an analysis. Romberg quotients are formed when the labels differ in eyes=open, closed only and both trials are valid, of one
/// person as far as is known, equally long and of one rate (posturography sheet section 6).
[[nodiscard]] Comparison compare(const MeasuredTrial& first, const MeasuredTrial& second);

[[nodiscard]] cli::Json to_json(const Comparison& comparison);
void print(const Comparison& comparison, const MeasuredTrial& first, const MeasuredTrial& second, cli::Console& console);

}  // namespace dts::lab::steadiness
