// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "posturography/analysis.h"
#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// Returns the core measures with their units, and the reference ranges that match the trial's labels.
[[nodiscard]] Table core_measures(const TrialData& trial);
/// Returns every measure, one family per row: planar (or of the resultant distance), AP, ML.
[[nodiscard]] Table all_measures(const TrialData& trial);
/// Returns the plain name of a measure: "Mean velocity".
[[nodiscard]] std::string measure_name(posturography::Measure measure);
/// Returns the plain name of a measure with its symbol: "Mean velocity (MVELO)".
[[nodiscard]] std::string measure_label(posturography::Measure measure);
/// Returns why the reference ranges on the page are doubtful for this trial; empty if there are no ranges or no doubts.
[[nodiscard]] std::vector<std::string> reference_warnings(const TrialData& trial);
/// Returns a short reason why a measure has no value.
[[nodiscard]] std::string why_absent(posturography::Measure measure, const posturography::Analysis& analysis);

}  // namespace dts::report
