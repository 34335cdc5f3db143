// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "posturography/measure.h"

namespace dts::posturography {

/// Who was measured, how, and who says so. Values of another protocol or another device do not compare (posturography sheet section 9): a
/// range is shown with all of this or not at all, and nothing is called normal or abnormal by it.
struct ReferenceProtocol {
  std::string_view id;        ///< "bds-young-eo-firm"
  std::string_view people;    ///< "36 people of 20 to 38 years, no illness, disability or fall reported"
  std::string_view protocol;  ///< "eyes open, firm surface, two feet, 60 s, 100 Hz, low-passed at 10 Hz by its authors, profile asis"
  std::string_view source;    ///< "computed here from Santos & Duarte 2016, PeerJ 4:e2648, CC BY 4.0"
  std::string_view eyes;      ///< "open", "closed": values of the label "eyes" it is for
  std::string_view surface;   ///< "firm", "foam"
  double duration_s = 0.0;
};

/// Median over people of the median of three trials, and the 5 to 95 % range.
struct ReferenceRange {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
};

[[nodiscard]] std::span<const ReferenceProtocol> reference_protocols() noexcept;
/// Nothing when that protocol has no value for the measure.
[[nodiscard]] std::optional<ReferenceRange> reference_range(const ReferenceProtocol& protocol, Measure measure) noexcept;

}  // namespace dts::posturography
