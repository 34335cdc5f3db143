// SPDX-License-Identifier: Apache-2.0
#include "lab/base/position_columns.h"

#include <utility>

namespace dts::lab {

void add_position_columns(std::vector<CsvColumn>& columns) {
  constexpr double kMostMm = 1e6;
  for (const char* name : {"x_mm", "y_mm", "ml_mm", "ap_mm"}) {
    columns.push_back({.name = name, .is_required = false, .may_be_empty = true, .minimum = -kMostMm, .maximum = kMostMm});
  }
}

std::optional<PositionColumns> position_columns(const std::string& file, const CsvTable& table, files::Problems& problems) {
  for (const PositionColumns& columns : {PositionColumns{"x_mm", "y_mm"}, PositionColumns{"ml_mm", "ap_mm"}}) {
    if (table.has(columns.ml) && table.has(columns.ap)) return columns;
  }
  for (const auto& [name, meaning] :
       {std::pair{"x_mm", "ML, positive to the subject's right; or ml_mm"}, std::pair{"y_mm", "AP, positive forward; or ap_mm"}}) {
    if (!table.has(name)) problems.push_back({file, 1, 1, "column '" + std::string(name) + "' is missing (" + meaning + ")"});
  }
  return std::nullopt;
}

}  // namespace dts::lab
