// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/study/experiments.h"

namespace dts::lab::study {

/// Figures of all draws beside what the thesis prints.
[[nodiscard]] cli::Json to_json(const std::vector<Draw>& draws);
void print(const std::vector<Draw>& draws, cli::Console& console);

/// "12 (3 max)": correct answers, and what the others were.
[[nodiscard]] std::string cell_text(const Confusion& answers, core::TrunkClass wanted);

}  // namespace dts::lab::study
