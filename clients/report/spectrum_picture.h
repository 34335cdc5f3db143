// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "posturography/measure.h"
#include "posturography/spectrum.h"
#include "report/canvas.h"

namespace dts::report {

/// Draws the densities of AP and ML over 0.15 to 5 Hz, both axes logarithmic, with PF50 and PF95 where they are defined. If there is
/// nothing to draw (no bin above 0), shows `why_not` instead.
void draw_spectra(Canvas& canvas, double width, double height, const posturography::Spectra& spectra,
                  const posturography::Measures& measures, const std::string& why_not);

}  // namespace dts::report
