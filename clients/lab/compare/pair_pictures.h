// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/compare/compare.h"
#include "report/page_content.h"

namespace dts::lab::compare {

/// One axis of a comparison, for pictures.
struct PairAxis {
  std::string name;  ///< "ML (x)"
  const std::vector<double>& a_mm;
  const std::vector<double>& b_mm;
  const AxisDifference& difference;
};

/// Draws both recordings against time, each relative to its own mean. The values must outlive the figure.
[[nodiscard]] report::Figure overlay_figure(const Paired& paired, const PairAxis& axis, const std::string& name_a,
                                            const std::string& name_b);
/// Draws the difference B - A against the mean of both, with bias and limits of agreement (Bland & Altman 1986). The values must outlive
/// the figure.
[[nodiscard]] report::Figure agreement_figure(const PairAxis& axis);

}  // namespace dts::lab::compare
