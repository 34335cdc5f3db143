// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "files/toml_reader.h"
#include "lab/csv.h"
#include "physics/cop/cop_estimator.h"
#include "physics/rig_model.h"

namespace dts::lab {

/// What `cop estimate` adds to each row.
inline constexpr std::array<const char*, 4> kEstimateColumns{"est_x_mm", "est_y_mm", "est_p_n", "flags"};

/// A POINTS.csv: `p_n,x_mm,y_mm,w1_mm,w2_mm,...`, one known load per row.
struct CopPoints {
  CsvTable table;
  std::vector<physics::CopSample> samples;  ///< One per row; what is not known is NaN.
};

/// Reads the load, its position and `sensor_count` deflections from every row. `needs_truth`: load and position must be there
/// and on `plate` (absent: anywhere), as for a fit; otherwise they may be missing, and
/// kEstimateColumns must be: they would come out twice.
[[nodiscard]] CopPoints read_cop_points(const std::string& file, std::size_t sensor_count, bool needs_truth,
                                        const std::optional<physics::Plate>& plate, files::Problems& problems);

/// Reads a rig file's physical part; the thesis's floor platform when `file` is empty.
[[nodiscard]] physics::RigModel read_rig(const std::string& file, files::Problems& problems);

}  // namespace dts::lab
