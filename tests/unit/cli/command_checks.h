// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "cli/command_line.h"

// For the tests of every command-line program: what they walk through.

namespace dts::cli {

/// Adds all commands below `command`, and itself.
inline void collect(const CLI::App& command, std::vector<const CLI::App*>& found) {
  found.push_back(&command);
  for (const CLI::App* subcommand : subcommands(command)) collect(*subcommand, found);
}

[[nodiscard]] inline std::vector<const CLI::App*> commands_of(const CLI::App& root) {
  std::vector<const CLI::App*> found;
  collect(root, found);
  return found;
}

/// The words of an example as a shell would give them; what follows ">" or "|" is not ours.
inline std::vector<std::string> shell_words(const std::string& line) {
  std::vector<std::string> words;
  bool is_quoted = false;
  bool is_open = false;
  for (const char letter : line + " ") {
    if (letter == '"') {
      is_quoted = !is_quoted;
      if (!is_open) words.emplace_back();
      is_open = true;
    } else if (letter == ' ' && !is_quoted) {
      is_open = false;
    } else {
      if (!is_open) words.emplace_back();
      is_open = true;
      words.back() += letter;
    }
  }
  const auto redirection = std::ranges::find_if(words, [](const std::string& word) { return word == ">" || word == "|"; });
  words.erase(redirection, words.end());
  return words;
}

}  // namespace dts::cli
