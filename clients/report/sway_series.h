// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "posturography/cop_series.h"
#include "posturography/prepare.h"
#include "report/canvas.h"

namespace dts::report {

/// AP and ML against time, one above the other, to the same scale in mm: what was analysed in colour, what was recorded beside it in grey,
/// missing samples as gaps. `prepared` may be nullptr: nothing was analysed.
void draw_sway_series(Canvas& canvas, double width, double height, const posturography::CopSeries& recorded,
                      const posturography::Prepared* prepared);

}  // namespace dts::report
