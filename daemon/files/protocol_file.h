// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "session/protocol.h"

namespace dts::files {

/// Reads a protocol file (see config/protocols/README.md). Adds every error to `problems`; the returned protocol is complete only if there
/// was no error.
[[nodiscard]] session::Protocol read_protocol(const std::string& file, Problems& problems);
/// Reads the same from a text, for protocols recorded with a session. `name` replaces the file name in problems.
[[nodiscard]] session::Protocol read_protocol_text(const std::string& text, const std::string& name, Problems& problems);
/// Returns the number of trials that a protocol's text plans; 0 if it plans none or cannot be read. Reads only the table [trials]: dtsd 0.1
/// recorded fields with other keys.
[[nodiscard]] std::uint32_t planned_trials(const std::string& definition);
/// Reads all *.toml files of a folder, sorted by name; a duplicate name is a problem. A missing folder is no problem. Always includes the
/// built-in protocol `free`, unless a file defines a protocol with that name.
[[nodiscard]] std::vector<session::Protocol> read_protocols(const std::string& folder, Problems& problems);

}  // namespace dts::files
