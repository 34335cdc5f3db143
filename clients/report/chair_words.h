// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/reach.h"
#include "report/chair_data.h"

namespace dts::report {

/// "none", "minor", "moderate", "maximum", "rejected"; "-" for nothing.
[[nodiscard]] std::string class_word(const std::optional<core::TrunkClass>& trunk_class);
/// Returns the class of a trial, or why there is none: "moderate", "rejected", "no reach", "scans missing", "-".
[[nodiscard]] std::string class_of(const ChairTrial& trial);
/// Returns why a reach was rejected, or what limits its class, one text per bit of core::class_reason.
[[nodiscard]] std::vector<std::string> reason_words(std::uint16_t reasons);
/// Returns the doubts about a reach, one text per bit of core::reach_flag.
[[nodiscard]] std::vector<std::string> flag_words(std::uint16_t flags);
/// Returns "done", or what is wrong: "redone: not valid", "done, not valid: no reach".
[[nodiscard]] std::string outcome_of(const ChairTrial& trial);
/// Returns why a trial that is done is not valid: "no reach"; empty if it is valid.
[[nodiscard]] std::string fault_of_reach(const ChairTrial& trial);
/// Returns "44.2 to 60.7"; "-" without an interval.
[[nodiscard]] std::string interval_text(const core::TrunkMovement& movement);

}  // namespace dts::report
