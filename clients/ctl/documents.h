// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "ctl/command_tree.h"
#include "ctl/console.h"

namespace dts::ctl {

/// Texts made from the command tree, so that they cannot disagree with it.

/// Completes commands and options: a bash-completion file.
[[nodiscard]] std::string bash_completion(const CLI::App& root);
/// The same for zsh, with descriptions: a file named _dtsctl in fpath.
[[nodiscard]] std::string zsh_completion(const CLI::App& root);
/// The manual page dtsctl(1), in man(7) macros.
[[nodiscard]] std::string manual_page(const CLI::App& root);

[[nodiscard]] int run_completion(const CommandTree& tree, Console& console);
[[nodiscard]] int run_manual(const CommandTree& tree, Console& console);

}  // namespace dts::ctl
