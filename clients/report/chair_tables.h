// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "report/chair_data.h"
#include "report/page_content.h"

namespace dts::report {

/// Returns a table with one trial per row: target, outcome, trunk class, angle, features. With more than `most_rows` trials, the table
/// states their number.
[[nodiscard]] Table reach_table(const ChairData& chair, std::size_t most_rows);
/// Returns the classes of the trials that are done, one target per row: also of those that are not valid without a reach.
[[nodiscard]] Table class_table(const ChairData& chair);
/// Returns mean and standard deviation of angle, rise and smoothness, one target per row.
[[nodiscard]] Table consistency_table(const ChairData& chair);
/// Returns the results of the session with their definitions.
[[nodiscard]] Table result_table(const ChairData& chair);
/// Returns the subject's own scale, or why it is unknown.
[[nodiscard]] Table scale_table(const ChairData& chair);
/// Returns the rejected reaches with their reasons; nothing if no reach was rejected.
[[nodiscard]] std::optional<Table> rejected_table(const ChairData& chair, std::size_t most_rows);

/// Returns class, probabilities and angle of one reach.
[[nodiscard]] Table movement_table(const ChairData& chair, const ChairTrial& trial);
/// Returns P1, P2, P3 and the features of one reach.
[[nodiscard]] Table feature_table(const ChairTrial& trial);

}  // namespace dts::report
