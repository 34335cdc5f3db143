// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "pipeline/reach/transient_history.h"

namespace dts::pipeline {

/// Returns the smoothness of the transient between two samples: the spectral arc length of its rate of change, normalised to its value at
/// frequency 0, up to the last frequency below 10 Hz at which it reaches 0.05 (Balasubramanian, Melendez-Calderon and Burdet 2012, A robust
/// and sensitive metric for quantifying movement smoothness; with the adaptive cut-off of Balasubramanian et al. 2015, On the analysis of
/// movement smoothness). Dimensionless, at most 0; a single smooth rise gives about -1.4 to -1.8. Returns NaN without movement or for fewer
/// than five samples. Allocates no memory, and its work is bounded. Realtime-safe: yes.
[[nodiscard]] double spectral_arc_length(const TransientHistory& history, std::uint64_t first, std::uint64_t last, double rate_hz) noexcept;

}  // namespace dts::pipeline
