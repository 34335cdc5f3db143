// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/compare/compare.h"

namespace dts::lab::compare {

/// What a report says about the two recordings.
struct PairNames {
  std::string session{};  ///< Empty: two files.
  std::string a;          ///< Rig or file name.
  std::string b;
};

/// Returns the report of a pair as one HTML page: alignment, table of differences, pictures, methods. The same comparison gives the same
/// bytes on every machine.
[[nodiscard]] std::string pair_report_html(const Comparison& comparison, const PairNames& names);

/// Returns the pictures of the report as an SVG of A4 size: both recordings over each other, and Bland-Altman, for ML (x) and AP (y).
[[nodiscard]] std::string pair_pictures_svg(const Comparison& comparison, const PairNames& names);

}  // namespace dts::lab::compare
