// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "posturography/reference_range.h"
#include "report/session_data.h"

namespace dts::report {

/// Reference protocols that match the eyes and surface of this trial, only for trials on two feet; never shows others (posturography sheet
/// section 9). At most three.
struct MatchedReferences {
  std::vector<posturography::ReferenceProtocol> protocols;
  bool is_surface_assumed = false;  ///< The trial has no label for the surface: firm is assumed, and the page must state that.
};
[[nodiscard]] MatchedReferences matched_references(const TrialData& trial);

/// Returns "8.640 (5.760-14.90)"; "" if the protocol has none.
[[nodiscard]] std::string range_text(const posturography::ReferenceProtocol& protocol, posturography::Measure measure);
[[nodiscard]] std::string footnote(const posturography::ReferenceProtocol& protocol, std::size_t number);
/// Warns that other durations and other filters change the values.
[[nodiscard]] std::vector<std::string> warnings(const MatchedReferences& references, const posturography::Analysis& analysis);

}  // namespace dts::report
