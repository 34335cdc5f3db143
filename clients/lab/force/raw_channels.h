// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Reads the volts of a DAQ: a CSV file with the columns t_s,c1,..,cN, and the plate to which they belong from the table [force_plate] of
/// `plate_file`. Fails with Failed, in one line: the first wrong key of `plate_file` with its place, or the first wrong cell.
[[nodiscard]] core::Result<ForceFile> read_raw_channels(const std::string& file, const std::string& plate_file);

/// Returns whether the first line of a file names t_s and c1.
[[nodiscard]] bool has_raw_channels(const std::string& file);

}  // namespace dts::lab::force
