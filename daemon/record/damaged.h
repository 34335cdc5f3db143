// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"

namespace dts::record {

/// What every reader of a file answers to bytes that no writer of ours makes.
inline constexpr core::ErrorCode kDamaged = core::ErrorCode::DataDamaged;

}  // namespace dts::record
