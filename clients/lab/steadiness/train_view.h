// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/steadiness/discriminant_evaluation.h"
#include "pattern/pattern_model.h"

namespace dts::lab::steadiness {

/// Prints how well the labels of people left out are predicted, and what may be said about it.
void print_result(const Evaluation& evaluation, const pattern::PatternModel& model, cli::Console& console);

/// Returns the same as JSON. `file`: the model's file; empty: none was written.
[[nodiscard]] cli::Json to_json(const Evaluation& evaluation, const pattern::PatternModel& model, const std::string& file);

}  // namespace dts::lab::steadiness
