// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// The time within which `share` (0..1) of the blocks got to the data socket: of those since `earlier`, an older state of the same
/// histogram, or of all when there is none. Evenly spread within a bucket; above the last finite bound it is that bound. Nothing: no blocks.
[[nodiscard]] std::optional<double> latency_quantile_ms(const v1::LatencyHistogram& now, double share,
                                                        const v1::LatencyHistogram* earlier = nullptr);

}  // namespace dts::ctl
