// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command_line.h"
#include "cli/console.h"

namespace dts::cli {

/// Texts made from the command line, so that they cannot disagree with it.

/// Completes commands and options: a bash-completion file.
[[nodiscard]] std::string bash_completion(const CommandLine& line);
/// The same for zsh, with descriptions: a file named _dtsctl in fpath.
[[nodiscard]] std::string zsh_completion(const CommandLine& line);
/// For the manual of a program with --json, in man(7) macros.
inline constexpr const char* kJsonErrors =
    "With\n.B \\-\\-json\na command that fails prints {\"error\": {\"code\", \"message\", \"hint\"}} unless it has printed a result; the "
    "code is "
    "a word such as not_found.\n";

/// The manual page dtsctl(1), in man(7) macros.
[[nodiscard]] std::string manual_page(const CommandLine& line);

/// Commands: print the script for `line.shell`, print the page. Both return the exit status.
[[nodiscard]] int print_completion(const CommandLine& line, Console& console);
[[nodiscard]] int print_manual(const CommandLine& line, Console& console);

}  // namespace dts::cli
