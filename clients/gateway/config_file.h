// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <string>

namespace dts::gateway {

/// Looks through a configuration file before CLI11 reads it, since CLI11 would wait for a pipe and names no lines. Returns "FILE:LINE: what
/// is wrong" for the first key or table that no option of `app` has; empty: nothing is wrong. Values are checked where they are used.
[[nodiscard]] std::string problem_of_config(const std::string& file, const CLI::App& app);

}  // namespace dts::gateway
