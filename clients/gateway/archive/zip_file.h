// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "core/result.h"

namespace dts::gateway {

/// Packs all files below `folder` into a new file `zip`, under their paths from there. The same files give the same bytes: names are in
/// order, and no times, owners or modes of the files are in it. Fails with LimitExceeded above `most_bytes`, with Failed when `is_wanted`
/// says no, and leaves nothing behind then. Returns its size.
[[nodiscard]] core::Result<std::uint64_t> write_zip(const std::filesystem::path& folder, const std::filesystem::path& zip,
                                                    std::uint64_t most_bytes, const std::function<bool()>& is_wanted);

}  // namespace dts::gateway
