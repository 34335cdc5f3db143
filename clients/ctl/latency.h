// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Returns the time within which `share` (0..1) of the blocks arrived at the data socket. Counts the blocks since `earlier`, an older state
/// of the same histogram, or all blocks if there is none. Interpolates linearly within a bucket; above the last finite bound it returns
/// that bound. Returns nothing if there are no blocks.
[[nodiscard]] std::optional<double> latency_quantile_ms(const v1::LatencyHistogram& now, double share,
                                                        const v1::LatencyHistogram* earlier = nullptr);

}  // namespace dts::ctl
