// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "posturography/reference_range.h"
#include "report/session_data.h"

namespace dts::report {

/// Reference protocols whose eyes and surface are this trial's, for trials on two feet: no others are ever shown (posturography sheet
/// section 9). At most three.
struct MatchedReferences {
  std::vector<posturography::ReferenceProtocol> protocols;
  bool is_surface_assumed = false;  ///< The trial does not say: firm is assumed, and the page must say so.
};
[[nodiscard]] MatchedReferences matched_references(const TrialData& trial);

/// "8.640 (5.760-14.90)"; "" when the protocol has none.
[[nodiscard]] std::string range_text(const posturography::ReferenceProtocol& protocol, posturography::Measure measure);
[[nodiscard]] std::string footnote(const posturography::ReferenceProtocol& protocol, std::size_t number);
/// Other durations and other filters give other values.
[[nodiscard]] std::vector<std::string> warnings(const MatchedReferences& references, const posturography::Analysis& analysis);

}  // namespace dts::report
