// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "record/catalogue/catalogue.h"

namespace dts::report {

/// The parts of a result's name: "romberg/feet=two/MVELO_part_2".
struct ResultName {
  std::string group;       ///< "romberg/feet=two", "eyes-open"; empty: of the whole session.
  std::string symbol;      ///< "MVELO", "trunk_sd_deg"
  std::uint32_t part = 1;  ///< Part of a resumed session.
};
[[nodiscard]] ResultName parts_of(const std::string& name);

/// Returns the plain name of a measure: "Mean velocity". An unknown symbol stays as it is.
[[nodiscard]] std::string plain_name(const std::string& symbol);
/// Returns the plain name of a result with its symbol behind it: "eyes-open: Mean velocity, AP (MVELO_AP)".
[[nodiscard]] std::string result_label(const std::string& name);

/// Returns why a trial that is done is not valid: "stepped off"; empty if it is valid.
[[nodiscard]] std::string fault_words(v1::TrialFault fault);

}  // namespace dts::report
