// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace dts::gateway {

/// Checks a configuration file before CLI11 reads it, because CLI11 would block on a pipe and reports no line numbers. Returns "FILE:LINE:
/// what is wrong" for the first key or table that no option of `app` has; empty if there is none. Values are checked where they are used.
[[nodiscard]] std::string problem_of_config(const std::string& file, const CLI::App& app);

}  // namespace dts::gateway
