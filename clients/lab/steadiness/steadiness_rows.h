// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/result.h"
#include "files/toml_reader.h"
#include "lab/force/standing_cop.h"
#include "posturography/measure.h"

namespace dts::lab::steadiness {

/// A row of a table that `dtslab sway --table` wrote. Unknown texts are empty; unknown numbers are NaN.
struct SteadinessRow {
  std::size_t line = 0;
  std::string file;
  std::string session;
  std::string subject;
  std::string trial;
  std::string label;                           ///< Content of the requested column.
  std::map<std::string, std::string> facts{};  ///< Content of the other requested columns, by name.
  std::string profile;
  double rate_hz = 0.0;
  double duration_s = 0.0;
  bool is_valid = true;  ///< Neither stepped_off nor moved.
  posturography::Measures measures;
};

/// Reads a table. `label` is the name of its required label column; empty: none. `facts`: other columns to read as text; those that the
/// table lacks are absent. Adds every error to `problems` with its position, also if a fact is a column of numbers that is read anyway.
[[nodiscard]] std::vector<SteadinessRow> read_rows(const std::string& file, const std::string& label, const std::vector<std::string>& facts,
                                                   files::Problems& problems);

/// Measures a file of force plates as `dtslab sway --profile PROFILE --rate RATE` does, and returns its one row. `rate_hz` = 0: at the rate
/// of the file.
[[nodiscard]] core::Result<SteadinessRow> row_of_plates(const std::string& file, const force::CopChoice& choice, const std::string& profile,
                                                        double rate_hz);

/// Returns the properties that affect the values and differ between the rows: "lp10 and asis", "duration 20 to 60 s"; empty if there are
/// none.
[[nodiscard]] std::vector<std::string> differences_of(const std::vector<SteadinessRow>& rows);

}  // namespace dts::lab::steadiness
