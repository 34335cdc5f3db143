// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "report/chair_data.h"
#include "report/page_content.h"

namespace dts::report {

/// Returns the files, devices and programs from which the numbers originate, for the parts [first_part, end_part).
[[nodiscard]] Notes provenance_of_chair(const ChairData& chair, std::size_t first_part, std::size_t end_part);
/// Returns a paragraph for a paper, with the literature to cite.
[[nodiscard]] Notes methods_of_chair(const ChairData& chair);
/// Describes what to expect of the trunk class and the angle: the figures of the recorded model.
[[nodiscard]] std::string model_note(const ChairData& chair);
/// Explains the words and signs of the pages.
[[nodiscard]] std::string explanation_of_chair();

}  // namespace dts::report
