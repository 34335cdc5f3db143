// SPDX-License-Identifier: Apache-2.0
#include "cli/help_formatter.h"

#include <algorithm>
#include <vector>

#include "cli/command_line.h"

namespace dts::cli {
namespace {

using Row = std::pair<std::string, std::string>;

constexpr std::size_t kWidestName = 44;

/// Returns a heading and two columns; a name that is too wide gets its own line.
std::string section(const std::string& title, const std::vector<Row>& rows) {
  if (rows.empty()) return {};
  std::size_t column = 0;
  for (const auto& [name, meaning] : rows) {
    if (name.size() <= kWidestName) column = std::max(column, name.size());
  }
  std::string text = "\n" + title + ":\n";
  for (const auto& [name, meaning] : rows) {
    text += "  " + name;
    if (name.size() > column) {
      text += "\n  " + std::string(column, ' ');
    } else {
      text += std::string(column - name.size(), ' ');
    }
    text += "  " + meaning + "\n";
  }
  return text;
}

std::vector<Row> rows_of(const std::vector<const CLI::Option*>& options) {
  std::vector<Row> rows;
  rows.reserve(options.size());
  for (const CLI::Option* option : options) {
    rows.emplace_back(option_label(*option), option->get_description() + (option->get_required() ? " (required)" : ""));
  }
  return rows;
}

}  // namespace

std::string HelpFormatter::make_help(const CLI::App* command, std::string /*name*/, CLI::AppFormatMode /*mode*/) const {
  const bool is_root = command->get_parent() == nullptr;
  const std::string& program = root_of(*command).get_name();
  std::vector<Row> tasks;
  for (const Example& example : examples(*command)) tasks.emplace_back(example.command, example.purpose);
  std::vector<Row> commands;
  for (const CLI::App* subcommand : subcommands(*command)) commands.emplace_back(subcommand->get_name(), subcommand->get_description());

  std::string text = command->get_description() + ".\n";
  text += section(is_root ? "Common tasks" : "Examples", tasks);
  text += "\nUsage: " + usage(*command) + "\n";
  text += section("Commands", commands);
  text += section("Arguments", rows_of(positionals(*command)));
  text += section("Options", rows_of(options(*command)));
  if (const auto found = glossaries_.find(command); found != glossaries_.end()) {
    for (const Glossary& glossary : found->second) text += section(glossary.title, glossary.words);
  }
  if (is_root) {
    text += "\nHelp for a command: " + program + " COMMAND --help. The manual: " + program + " man | man -l -\n";
  } else {
    std::string names;
    for (const CLI::Option* option : options(root_of(*command))) {
      if (option->get_configurable()) names += (names.empty() ? "" : ", ") + option_label(*option);
    }
    if (!names.empty()) text += "\nOptions of every command: " + names + " (see " + program + " --help)\n";
  }
  return text;
}

}  // namespace dts::cli
