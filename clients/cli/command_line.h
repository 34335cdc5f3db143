// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cli/console.h"

namespace dts::cli {

/// Executes a command and returns the exit status.
using Handler = std::function<int(Console& console)>;

/// Contents of the manual page, besides the commands. Plain text unless noted otherwise.
struct Manual {
  using Entry = std::pair<std::string, std::string>;  ///< Name and meaning.

  std::string summary;      ///< Follows the program's name: "command line of the daemon".
  std::string description;  ///< Sentences, in man(7) macros.
  std::vector<Entry> environment;
  std::vector<int> exit_statuses;  ///< The statuses of kExitMeanings that this program uses.
  std::string further_sections;    ///< In man(7) macros, each with its .SH.
  std::vector<Entry> files;
  std::vector<std::pair<std::string, int>> see_also;  ///< {"jq", 1}
};

struct Program {
  std::string name;          ///< "dtsctl"
  std::string version;       ///< "0.1.0"
  std::string description;   ///< Without full stop.
  std::string examples;      ///< Common tasks, lines of "command | purpose".
  bool takes_files = false;  ///< Completion also offers file names.
};

/// Words in a command's results, with their meanings; shown in its help and in the manual page.
struct Glossary {
  std::string title;  ///< "Measures"
  std::vector<Manual::Entry> words;
};
using Glossaries = std::map<const CLI::App*, std::vector<Glossary>>;

/// A command-line program: its commands with options, help and examples. Help, completion and the manual page are generated from it. Holds
/// pointers to itself, so it must not be moved.
struct CommandLine {
  explicit CommandLine(Program about);

  const Program program;
  CLI::App app;
  Manual manual;
  std::map<const CLI::App*, Handler> handlers;
  Glossaries glossaries;
  std::string shell;  ///< The argument of `completion`.
};

/// Adds a command that only groups its subcommands. `examples`: lines of "command | purpose".
CLI::App* add_group(CLI::App& parent, const std::string& name, const std::string& description, const std::string& examples);
/// Adds a command that executes `handler`.
CLI::App* add_command(CommandLine& line, CLI::App& parent, const std::string& name, const std::string& description,
                      const std::string& examples, Handler handler);
/// Makes the program work without a command: `handler` runs if the words name none.
void run_without_command(CommandLine& line, Handler handler);
/// Adds the words that a command prints to its help and to the manual page: lines of "WORD | meaning".
void explain(CommandLine& line, const CLI::App& command, const std::string& words);
/// Adds what every program has, after the program's own commands: `--version`, and the commands `completion` and `man`.
void add_common(CommandLine& line);

/// One example of a command: "command line  what it does".
struct Example {
  std::string command;
  std::string purpose;
};
[[nodiscard]] std::vector<Example> examples(const CLI::App& command);

/// Returns the visible subcommands, in the order of their definition.
[[nodiscard]] std::vector<const CLI::App*> subcommands(const CLI::App& command);
/// Returns the options that are not positional.
[[nodiscard]] std::vector<const CLI::Option*> options(const CLI::App& command);
[[nodiscard]] std::vector<const CLI::Option*> positionals(const CLI::App& command);
/// Returns "--count N", "--json", "RIG".
[[nodiscard]] std::string option_label(const CLI::Option& option);
/// Returns "dtsctl session start".
[[nodiscard]] std::string full_name(const CLI::App& command);
/// Returns true if the words must name one of the subcommands of `command`.
[[nodiscard]] bool needs_command(const CLI::App& command);
/// Returns "dtsctl session start --rig RIG [OPTIONS]".
[[nodiscard]] std::string usage(const CLI::App& command);
/// Returns the program itself.
[[nodiscard]] const CLI::App& root_of(const CLI::App& command);

}  // namespace dts::cli
