// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "posturography/analysis.h"
#include "report/page_content.h"
#include "report/session_data.h"

namespace dts::report {

/// The core measures with their units, and the reference ranges that the trial's labels allow.
[[nodiscard]] Table core_measures(const TrialData& trial);
/// Every measure, a family a row: planar (or of the resultant distance), AP, ML.
[[nodiscard]] Table all_measures(const TrialData& trial);
/// What makes the reference ranges of the page doubtful for this trial; empty: there are none, or nothing does.
[[nodiscard]] std::vector<std::string> reference_warnings(const TrialData& trial);
/// Why a measure has no value, in a few words.
[[nodiscard]] std::string why_absent(posturography::Measure measure, const posturography::Analysis& analysis);

}  // namespace dts::report
