// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command_line.h"
#include "cli/console.h"

namespace dts::cli {

/// Documents generated from the command line, so that they always match it.

/// Returns a bash-completion file that completes commands and options.
[[nodiscard]] std::string bash_completion(const CommandLine& line);
/// Returns the same for zsh, with descriptions: a file named _dtsctl in fpath.
[[nodiscard]] std::string zsh_completion(const CommandLine& line);
/// Text about JSON errors for the manual of a program with --json, in man(7) macros.
inline constexpr const char* kJsonErrors =
    "With\n.B \\-\\-json\na command that fails prints {\"error\": {\"code\", \"message\", \"hint\"}}, unless it already printed a result. "
    "The "
    "code is a word, for example not_found.\n";

/// Returns the manual page dtsctl(1), in man(7) macros.
[[nodiscard]] std::string manual_page(const CommandLine& line);

/// Handlers of the commands `completion` (for `line.shell`) and `man`. Both return the exit status.
[[nodiscard]] int print_completion(const CommandLine& line, Console& console);
[[nodiscard]] int print_manual(const CommandLine& line, Console& console);

}  // namespace dts::cli
