// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/toml_reader.h"
#include "lab/base/csv.h"

namespace dts::lab {

/// Names of a table's centre-of-pressure columns: x_mm, y_mm, or ml_mm, ap_mm as `dtsctl session export` writes them.
struct PositionColumns {
  std::string ml;
  std::string ap;
};

/// Adds both pairs, each optional, to the columns to read.
void add_position_columns(std::vector<CsvColumn>& columns);
/// Returns whether a table with columns of these names has one of the pairs.
[[nodiscard]] bool has_position_columns(std::span<const std::string_view> names);
/// Returns the pair that the table has. If there is none, returns nothing and adds a problem for each missing column.
[[nodiscard]] std::optional<PositionColumns> position_columns(const std::string& file, const CsvTable& table, files::Problems& problems);

}  // namespace dts::lab
