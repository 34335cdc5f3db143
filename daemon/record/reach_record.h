// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/reach.h"
#include "core/result.h"
#include "record/event.h"

namespace dts::record {

/// Event "reach": step ("p1", "p2", "p3", "final", "cancelled"), number, p1_scan, p1_mm, p2_scan, p2_mm, p3_scan, p3_mm, hold_mm, rise_s,
/// rest_ratio, ratio_change, twist, smoothness, flags, resumed. Numbers read back as the same double; an unknown value is null.
[[nodiscard]] RecordedEvent to_record(const core::ReachEvent& event);
/// Fails with DataDamaged if a key is missing, has the wrong type or is out of range; the message names the key.
[[nodiscard]] core::Result<core::ReachEvent> reach_of(const RecordedEvent& event);

/// Event "class": number, class, p_1, p_2, p_3, trunk_deg, trunk_lo_deg, trunk_hi_deg, reasons.
[[nodiscard]] RecordedEvent to_record(const core::ClassEvent& event);
/// Fails like `reach_of`.
[[nodiscard]] core::Result<core::ClassEvent> class_of(const RecordedEvent& event);

}  // namespace dts::record
