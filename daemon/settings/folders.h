// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::settings {

/// Returns the folder of the sockets: $DTSD_RUNTIME_DIR, else systemd's $RUNTIME_DIRECTORY, else $XDG_RUNTIME_DIR/dtsd, else
/// /tmp/dtsd-<uid>. Clients follow the same rule.
[[nodiscard]] std::string runtime_directory();

/// Returns the folder of the recordings and the catalogue: $DTSD_STATE_DIR, else systemd's $STATE_DIRECTORY, else $XDG_STATE_HOME/dtsd,
/// else ~/.local/state/dtsd, else a folder in the runtime directory.
[[nodiscard]] std::string state_directory();

}  // namespace dts::settings
