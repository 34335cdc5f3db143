// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "lab/sway/measured_trial.h"

namespace dts::lab::steadiness {

/// Many trials as one CSV: a row for each, with the columns file, session, subject, trial, attempt, condition, one for each label's name,
/// profile, fs_hz, n, duration_s, flags (joined by a bar), then every measure by its symbol. What is not known is empty.
[[nodiscard]] std::string table_text(std::span<const MeasuredTrial> trials);

/// Whether tables have a column of that name that is no label.
[[nodiscard]] bool is_column_of_table(std::string_view name);

/// `core::csv_cell`; line ends become spaces, since `CsvTable` reads line by line.
[[nodiscard]] std::string cell_text(std::string_view text);
/// As many digits as the number needs to be read back the same.
[[nodiscard]] std::string number_text(double value);

}  // namespace dts::lab::steadiness
