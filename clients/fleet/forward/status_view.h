// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "cli/console.h"
#include "fleet/forward/store.h"

namespace dts::fleet::forward {

/// Prints what waits, what is under way, when the centre last answered and why something is not sent. `utc_ns`: now. Returns the exit
/// status: 0, or 1 if the store cannot be read or the program does not run.
[[nodiscard]] int print_status(const Store& store, const std::string& clinic, std::int64_t utc_ns, bool is_json, cli::Console& console);

/// Prints what is known of the recording with this checksum. Returns 0 only if the centre has it: a script may ask this before it removes a
/// recording. Otherwise 6 (it is not there yet), 5 (unknown here) or 2 (not a SHA-256).
[[nodiscard]] int print_file(const Store& store, const std::string& sha256, bool is_json, cli::Console& console);

}  // namespace dts::fleet::forward
