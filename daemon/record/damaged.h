// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"

namespace dts::record {

/// The error of every file reader for bytes that our writers never produce.
inline constexpr core::ErrorCode kDamaged = core::ErrorCode::DataDamaged;

}  // namespace dts::record
