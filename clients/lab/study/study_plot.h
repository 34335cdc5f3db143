// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "core/result.h"
#include "lab/study/experiments.h"

namespace dts::lab::study {

/// Draws the confusions of the ten healthy volunteers by NN1, NN2 and the recommended model with its own scale, and the windows of trunk
/// angles.
[[nodiscard]] core::Status draw_study(const Draw& draw, const std::string& file);
/// Returns the script for gnuplot without the terminal; for tests.
[[nodiscard]] std::string study_script(const Draw& draw);

}  // namespace dts::lab::study
