// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "dts/error.h"
#include "physics/sensor_calibration.h"

namespace dts::ctl {

/// Reads a CSV file with the header `gap_mm,volts`; the row of a reading is its line in the file. Fails with InvalidArgument, naming
/// "file:line:column".
[[nodiscard]] client::Result<std::vector<physics::GapReading>> read_gap_table(const std::string& file);

}  // namespace dts::ctl
