// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
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
/// Returns the decisions of the rig's steadiness model about kept trials, as dtsd recorded them, with what must be known to read them;
/// nothing without a decision, and nothing for a person's record: a decision is no finding.
[[nodiscard]] std::optional<Table> decision_table(const SessionData& session, std::span<const TrialData> trials);

}  // namespace dts::report
