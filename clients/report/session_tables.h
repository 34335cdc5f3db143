// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// Returns a table with one trial per row: condition, outcome, main measures. With more than `most_rows` trials, the table states their
/// number.
[[nodiscard]] Table trial_table(const SessionData& session, std::size_t most_rows);
/// Returns the means of the core measures over the trials that count, with conditions side by side, a few per table.
[[nodiscard]] std::vector<Table> condition_tables(const SessionData& session);
/// Returns eyes closed over eyes open, beside published values for the same stance; nothing if no two conditions form a pair.
[[nodiscard]] std::optional<Table> romberg_table(const SessionData& session);

}  // namespace dts::report
