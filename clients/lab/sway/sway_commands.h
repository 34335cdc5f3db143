// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab::steadiness {

/// `dtslab sway`: measures the steadiness of centres of pressure from files and recordings.
[[nodiscard]] int run_sway(const Arguments& arguments, cli::Console& console);
/// `dtslab steadiness train`, `dtslab steadiness classify`: distinguishes groups or conditions by their measures.
[[nodiscard]] int run_train(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_classify(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab::steadiness
