// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// A trial a row: condition, outcome, main measures. Of more than `most_rows` the table tells how many there are.
[[nodiscard]] Table trial_table(const SessionData& session, std::size_t most_rows);
/// Means of the core measures over the trials that count: conditions side by side, a few to a table.
[[nodiscard]] std::vector<Table> condition_tables(const SessionData& session);
/// Eyes closed over eyes open, beside what was published for the same stance; nothing when no two conditions make one.
[[nodiscard]] std::optional<Table> romberg_table(const SessionData& session);

}  // namespace dts::report
