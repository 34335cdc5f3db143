// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "files/toml_reader.h"
#include "lab/base/csv.h"
#include "physics/cop/cop_estimator.h"

namespace dts::lab::cop {

/// Columns that `cop estimate` adds to each row.
inline constexpr std::array<const char*, 4> kEstimateColumns{"est_x_mm", "est_y_mm", "est_p_n", "flags"};

/// Columns about a person on two feet, for `cop estimate`; all optional. Rows with the same `person` are one stance.
inline constexpr const char* kPersonColumn = "person";
inline constexpr const char* kWidthColumn = "stated_width_mm";
inline constexpr const char* kWeightColumn = "stated_weight_n";

/// A POINTS.csv file: `p_n,x_mm,y_mm,w1_mm,w2_mm,...`, one known load per row.
struct CopPoints {
  CsvTable table;
  std::vector<physics::CopSample> samples;  ///< One per row; unknown values are NaN.
};

/// Reads the load, its position and `sensor_count` deflections from every row. With `needs_truth`, as for a fit, load and position are
/// required, and the position must be on `plate` (absent: anywhere). Without it, load and position are optional, as are the columns about a
/// person, and the file must not have kEstimateColumns, because the output would have them twice.
[[nodiscard]] CopPoints read_cop_points(const std::string& file, std::size_t sensor_count, bool needs_truth,
                                        const std::optional<physics::Plate>& plate, files::Problems& problems);

}  // namespace dts::lab::cop
