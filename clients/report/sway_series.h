// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "posturography/cop_series.h"
#include "posturography/prepare.h"
#include "report/canvas.h"

namespace dts::report {

/// Draws AP and ML against time, one above the other, with the same scale in mm: the analysed data in colour, the other recorded data in
/// grey, missing samples as gaps. `prepared` is nullptr if nothing was analysed.
void draw_sway_series(Canvas& canvas, double width, double height, const posturography::CopSeries& recorded,
                      const posturography::Prepared* prepared);

}  // namespace dts::report
