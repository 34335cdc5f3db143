// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "posturography/cop_series.h"

namespace dts::posturography {

/// Samples [begin, end) of a series, with gaps of up to 50 ms.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t size() const noexcept { return end - begin; }
};

/// What longer gaps leave of a series (posturography sheet section 7). A sample is missing if its position is missing or farther than 1e9
/// mm, or if its load is known and not above 0: nobody is on the plate.
struct CleanStretches {
  std::vector<Stretch> all;  ///< In the order of time.
  std::size_t missing = 0;   ///< Missing samples of the series.

  /// Returns the first of the longest; empty if there is none.
  [[nodiscard]] Stretch longest() const noexcept;
  /// Returns true if a longer gap divides the series, or takes its beginning or its end.
  [[nodiscard]] bool is_cut(const CopSeries& series) const noexcept;
};
[[nodiscard]] CleanStretches clean_stretches(const CopSeries& series);

/// Both columns of a stretch minus their first values, with gaps interpolated linearly. Subtracting the first value makes a constant
/// exactly 0, and avoids losing digits far from the origin.
struct StretchCopy {
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
  double first_ml_mm = 0.0;
  double first_ap_mm = 0.0;
  std::size_t interpolated = 0;  ///< Samples.
};
/// `stretch` is not empty and begins with a sample that is present.
[[nodiscard]] StretchCopy copy_of(const CopSeries& series, const Stretch& stretch);

}  // namespace dts::posturography
