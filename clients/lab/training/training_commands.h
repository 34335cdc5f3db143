// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "lab/arguments.h"

namespace dts::lab::training {

/// `dtslab reach train | classify | export | import`. Each returns the exit status.
[[nodiscard]] int run_reach_train(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_reach_classify(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_reach_export(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_reach_import(const Arguments& arguments, cli::Console& console);

}  // namespace dts::lab::training
