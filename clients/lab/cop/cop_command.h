// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/command_line.h"
#include "core/result.h"

namespace dts::lab::cop {

/// Adds `dtslab cop fit`, `cop estimate`, `cop two-feet` and `cop evaluate`.
void add_commands(cli::CommandLine& line);

/// Adds `cop estimate` to the group `cop`.
void add_estimate(cli::CommandLine& line, CLI::App& cop);
/// Adds `cop two-feet`.
void add_two_feet(cli::CommandLine& line, CLI::App& cop);
/// Adds `cop evaluate`.
void add_evaluate(cli::CommandLine& line, CLI::App& cop);
/// Adds `--estimator NAME`.
void add_estimator(CLI::App& command, std::string& estimator, const std::vector<std::string>& names);

/// Returns the time of day as a calibration has it: "2026-01-31T12:00:00Z".
[[nodiscard]] std::string now_utc();
/// Fails with InvalidArgument if `out` exists: a calibration is never overwritten.
[[nodiscard]] core::Status check_is_new(const std::string& out);

}  // namespace dts::lab::cop
