// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/sway/measured_trial.h"

namespace dts::lab::sway {

/// A measure of the core set, and its values in two trials.
struct ComparedMeasure {
  posturography::Measure measure{};
  double first = 0.0;
  double second = 0.0;
  std::optional<double> percent;  ///< (second - first) / first; only for ratio-scaled measures above 0.
  std::optional<double> romberg;  ///< Eyes closed / eyes open.
};

/// Two trials side by side.
struct Comparison {
  std::vector<ComparedMeasure> measures;  ///< The measures that both trials have.
  bool has_romberg = false;
  std::vector<std::string> warnings;  ///< Reasons why the trials are not well comparable; always shown.
};

/// Compares two analysed trials. Computes Romberg quotients only if the labels differ only in eyes=open and eyes=closed, both trials are
/// valid, have equal durations and rates, and are not known to be of different people (posturography sheet section 6).
[[nodiscard]] Comparison compare(const MeasuredTrial& first, const MeasuredTrial& second);

[[nodiscard]] cli::Json to_json(const Comparison& comparison);
void print(const Comparison& comparison, const MeasuredTrial& first, const MeasuredTrial& second, cli::Console& console);

}  // namespace dts::lab::sway
