// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/sway/measured_trial.h"
#include "lab/sway/sway_arguments.h"

namespace dts::lab::sway {

/// Formats a number for people with `digits` significant digits: "8.0696".
[[nodiscard]] std::string significant(double value, int digits = 5);

/// Returns a trial as contract.md describes it, with additional facts.
[[nodiscard]] cli::Json to_json(const MeasuredTrial& trial, const SwayArguments& arguments);

/// Prints every measure of one trial, in groups with descriptions, and its flags with their sentences.
void print_measures(const MeasuredTrial& trial, cli::Console& console);
/// Prints one line per trial with the most important measures.
void print_overview(std::span<const MeasuredTrial> trials, cli::Console& console);
/// Prints how many of the results that dtsd recorded differ from those computed here; nothing if dtsd recorded none.
void print_live(std::span<const MeasuredTrial> trials, cli::Console& console);

}  // namespace dts::lab::sway
