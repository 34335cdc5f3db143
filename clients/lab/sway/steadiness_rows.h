// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "posturography/measure.h"

namespace dts::lab::steadiness {

/// A row of a table as `dtslab sway --table` writes it. Texts are empty and numbers NaN where the table does not say.
struct SteadinessRow {
  std::size_t line = 0;
  std::string file;
  std::string session;
  std::string subject;
  std::string trial;
  std::string label;  ///< What stands in the column that was asked for.
  std::string profile;
  double rate_hz = 0.0;
  double duration_s = 0.0;
  bool is_valid = true;  ///< Neither stepped_off nor moved.
  posturography::Measures measures;
};

/// Reads a table. `label`: its column, required; empty: none. Everything wrong is added to `problems` with its place.
[[nodiscard]] std::vector<SteadinessRow> read_rows(const std::string& file, const std::string& label, files::Problems& problems);

/// "lp10 and asis", "duration 20 to 60 s": in what the rows differ that values depend on; empty: in nothing.
[[nodiscard]] std::vector<std::string> differences_of(const std::vector<SteadinessRow>& rows);

}  // namespace dts::lab::steadiness
