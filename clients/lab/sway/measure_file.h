// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "files/toml_reader.h"
#include "lab/sway/measured_trial.h"
#include "lab/sway/sway_arguments.h"
#include "lab/sway/sway_inputs.h"

namespace dts::lab::sway {

/// The result of one file. With problems or an error there are no trials.
struct MeasuredFile {
  std::vector<MeasuredTrial> trials;
  files::Problems problems;          ///< Of a CSV file, each with its position.
  std::optional<core::Error> error;  ///< Of a recording, or of a file of force plates.
  std::string damage;                ///< Of a recording that was read up to a torn place, or was recovered.
};

/// Returns how to prepare a file's centres of pressure, from the command line.
[[nodiscard]] posturography::AnalysisOptions options_of(const SwayArguments& arguments, bool is_recording);

/// Reads and measures every requested trial of a file. Calls `progress` with 0..1.
[[nodiscard]] MeasuredFile measure_file(const SwayInput& input, const SwayArguments& arguments,
                                        const std::function<void(double)>& progress);

/// Returns whether two analyses of one trial are equal, except for the last digits, which another machine may round differently.
[[nodiscard]] bool is_same(const posturography::Analysis& a, const posturography::Analysis& b);

}  // namespace dts::lab::sway
