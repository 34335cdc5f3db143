// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/sway/measured_trial.h"
#include "lab/sway/sway_arguments.h"

namespace dts::lab::steadiness {

/// "8.0696": `digits` significant ones, for people.
[[nodiscard]] std::string significant(double value, int digits = 5);

/// A trial as contract.md describes it, with what else is to be known about it.
[[nodiscard]] cli::Json to_json(const MeasuredTrial& trial, const SwayArguments& arguments);

/// Every measure of one trial, in groups, with what it is; its flags with their sentences.
void print_measures(const MeasuredTrial& trial, cli::Console& console);
/// A line for each trial with the measures that are looked at first.
void print_overview(std::span<const MeasuredTrial> trials, cli::Console& console);
/// How many of dtsd's own results are not those computed here; nothing when it told none.
void print_told(std::span<const MeasuredTrial> trials, cli::Console& console);

}  // namespace dts::lab::steadiness
