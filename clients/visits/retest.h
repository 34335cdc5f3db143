// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "visits/series.h"

namespace dts::visits {

/// How much a measure differs between two days although nothing has changed.
struct Retest {
  double percent = 0.0;  ///< Of the mean of both values: 95 % of the differences between two days are smaller.
  const char* source = "";

  /// Returns the same for a rise and the fall back.
  [[nodiscard]] bool is_within(double one, double other) const noexcept;
};

/// Returns the published variation of a measure between two days; nullptr if none is known for this
/// condition and for trials as long as those of the newest point. Nothing is estimated here: see the README.
[[nodiscard]] const Retest* retest_of(const Series& series) noexcept;

}  // namespace dts::visits
