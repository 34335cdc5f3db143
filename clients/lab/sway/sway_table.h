// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "lab/sway/measured_trial.h"

namespace dts::lab::sway {

/// Returns many trials as one CSV text, one row per trial. Columns: file, session, subject, trial, attempt, condition, one for each label's
/// name, profile, fs_hz, n, duration_s, flags (joined by a bar), then every measure by its symbol. Unknown values are empty.
[[nodiscard]] std::string table_text(std::span<const MeasuredTrial> trials);

/// Returns whether tables have a column of that name that is not a label.
[[nodiscard]] bool is_column_of_table(std::string_view name);

/// As `core::csv_cell`, but line ends become spaces, because `CsvTable` reads line by line.
[[nodiscard]] std::string cell_text(std::string_view text);
/// Returns as many digits as are needed to read back the same number.
[[nodiscard]] std::string number_text(double value);

}  // namespace dts::lab::sway
