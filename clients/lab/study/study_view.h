// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/study/experiments.h"

namespace dts::lab::study {

/// Returns the figures of all draws beside those printed in the thesis.
[[nodiscard]] cli::Json to_json(const std::vector<Draw>& draws);
void print(const std::vector<Draw>& draws, cli::Console& console);

/// Returns for example "12 (3 max)": correct answers, and the other answers.
[[nodiscard]] std::string cell_text(const Confusion& answers, core::TrunkClass wanted);

}  // namespace dts::lab::study
