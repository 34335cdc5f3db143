// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "lab/csv.h"

namespace dts::lab {

/// The names of a table's columns with the centre of pressure: x_mm, y_mm, or ml_mm, ap_mm of `dtsctl session export`.
struct PositionColumns {
  std::string ml;
  std::string ap;
};

/// Both pairs, each optional, to the columns that are read.
void add_position_columns(std::vector<CsvColumn>& columns);
/// The pair that the table has. Nothing, and a problem for each that is missing, when there is none.
[[nodiscard]] std::optional<PositionColumns> position_columns(const std::string& file, const CsvTable& table, files::Problems& problems);

}  // namespace dts::lab
