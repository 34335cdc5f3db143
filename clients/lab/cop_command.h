// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab {

/// `dtslab cop fit`, `dtslab cop estimate`, `dtslab cop evaluate`. Each returns the exit status.
[[nodiscard]] int run_cop_fit(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_cop_estimate(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_cop_evaluate(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab
