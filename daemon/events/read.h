// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/reach.h"
#include "core/result.h"
#include "dts/v1/stream.pb.h"
#include "posturography/analysis.h"

/// Reads events of any source, also of a file that somebody forged. Thread: any.
namespace dts::events {

/// Fails with DataDamaged, naming the field, if the event is no reach or a value is out of range.
[[nodiscard]] core::Result<core::ReachEvent> reach_of(const v1::Event& event);
/// Fails like `reach_of`.
[[nodiscard]] core::Result<core::ClassEvent> class_of(const v1::Event& event);
/// Fails with DataDamaged, naming the field, if a value is missing or out of range. Skips measures that this program does not know or has
/// in another unit.
[[nodiscard]] core::Result<posturography::Analysis> analysis_of(const v1::Sway& sway);

/// Returns the error DataDamaged for a field of an event.
[[nodiscard]] core::Error damaged(const v1::Event& event, const char* field);

}  // namespace dts::events
