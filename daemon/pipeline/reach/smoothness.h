// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "pipeline/reach/transient_history.h"

namespace dts::pipeline {

/// Smoothness of the transient between two samples: the spectral arc length of its rate of change, normalised to its value at frequency 0,
/// up to 10 Hz at most and no further than where it last exceeds 0.05 (Balasubramanian, Melendez-Calderon and Burdet 2012, A robust and
/// sensitive metric for quantifying movement smoothness; with the adaptive cut-off of Balasubramanian et al. 2015, On the analysis of
/// movement smoothness). Dimensionless, at most 0; a single smooth rise gives about -1.4 to -1.8. NaN when nothing moves or there are
/// fewer than four samples. No memory is taken and the work is bounded. Realtime-safe: yes.
[[nodiscard]] double spectral_arc_length(const TransientHistory& history, std::uint64_t first, std::uint64_t last, double rate_hz) noexcept;

}  // namespace dts::pipeline
