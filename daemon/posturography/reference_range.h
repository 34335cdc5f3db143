// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "posturography/measure.h"

namespace dts::posturography {

/// Who was measured, how, and by which source. Values from another protocol or another device are not comparable (posturography sheet
/// section 9): show a range with all of these facts or not at all, and never call a value normal or abnormal because of it.
struct ReferenceProtocol {
  std::string_view id;        ///< "bds-young-eo-firm"
  std::string_view people;    ///< "36 people of 20 to 38 years, no illness, disability or fall reported"
  std::string_view protocol;  ///< "eyes open, firm surface, two feet, 60 s, 100 Hz, low-passed at 10 Hz by its authors, profile asis"
  std::string_view source;    ///< "computed here from Santos & Duarte 2016, PeerJ 4:e2648, CC BY 4.0"
  std::string_view eyes;      ///< "open", "closed": required value of the label "eyes"
  std::string_view surface;   ///< "firm", "foam"
  double duration_s = 0.0;
};

/// Median over people of the median of three trials, and the range from 5 to 95 %.
struct ReferenceRange {
  double median = 0.0;
  double low = 0.0;
  double high = 0.0;
};

[[nodiscard]] std::span<const ReferenceProtocol> reference_protocols() noexcept;
/// Returns nothing if the protocol has no value for the measure.
[[nodiscard]] std::optional<ReferenceRange> reference_range(const ReferenceProtocol& protocol, Measure measure) noexcept;

}  // namespace dts::posturography
