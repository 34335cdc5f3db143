// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "files/toml_reader.h"
#include "session/protocol.h"

namespace dts::files {

/// Reads a protocol file (see config/protocols/README.md). Everything wrong is added to `problems`; what is returned is complete only when
/// nothing was.
[[nodiscard]] session::Protocol read_protocol(const std::string& file, Problems& problems);
/// The same from a text, for protocols recorded with a session; `name` stands for the file in problems.
[[nodiscard]] session::Protocol read_protocol_text(const std::string& text, const std::string& name, Problems& problems);
/// Trials that a protocol's text plans; 0: it plans none, or does not read.
[[nodiscard]] std::uint32_t planned_trials(const std::string& definition);
/// All *.toml of a folder, by name; a name that stands twice is a problem. A folder that is not there has none. The built-in `free` is
/// always among them, unless a file describes another protocol of that name.
[[nodiscard]] std::vector<session::Protocol> read_protocols(const std::string& folder, Problems& problems);

}  // namespace dts::files
