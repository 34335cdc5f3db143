// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "core/result.h"

namespace dts::gateway {

/// Packs all files below `folder` into a new file `zip`, with their paths relative to `folder`. The same files always give the same bytes:
/// names are sorted, and times, owners and modes are not stored. Fails with LimitExceeded above `most_bytes`, and with Failed if
/// `is_wanted` returns false; then it leaves no file behind. Returns the size of the zip file.
[[nodiscard]] core::Result<std::uint64_t> write_zip(const std::filesystem::path& folder, const std::filesystem::path& zip,
                                                    std::uint64_t most_bytes, const std::function<bool()>& is_wanted);

}  // namespace dts::gateway
