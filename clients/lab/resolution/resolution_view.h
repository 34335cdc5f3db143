// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "cli/json.h"
#include "lab/base/plot.h"
#include "lab/resolution/resolution.h"

namespace dts::lab::resolution {

void print(const Resolution& resolution, cli::Console& console);
[[nodiscard]] cli::Json to_json(const Resolution& resolution);
/// The smallest turn of each person and the median, over the noise.
[[nodiscard]] CurvePlot picture_of(const Resolution& resolution);

}  // namespace dts::lab::resolution
