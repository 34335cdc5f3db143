// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <string>

#include "cli/documents.h"
#include "cli/exit_status.h"

namespace dts::cli {
namespace {

/// Escapes text for roff: backslashes, hyphens (so that they can be copied), and lines that would start as a macro.
std::string roff(const std::string& text) {
  std::string safe;
  for (const char letter : text) {
    if (safe.empty() && (letter == '.' || letter == '\'')) safe += "\\&";
    if (letter == '\\') {
      safe += "\\e";
    } else if (letter == '-') {
      safe += "\\-";
    } else if (letter == '"') {
      safe += "\\(dq";  // a plain quotation mark would group the words of a macro
    } else {
      safe += letter;
    }
  }
  return safe;
}

std::string tagged(const std::string& tag, const std::string& text) { return ".TP\n.B " + roff(tag) + "\n" + roff(text) + "\n"; }

std::string option_text(const CLI::Option& option) {
  return tagged(option_label(option), option.get_description() + (option.get_required() ? " (required)." : "."));
}

std::string example_text(const CLI::App& command) {
  std::string text;
  for (const Example& example : examples(command))
    text += tagged(example.command, example.purpose + (example.purpose.ends_with('?') ? "" : "."));
  return text;
}

/// Describes a command with its options; a group like "session" only describes its subcommands.
void describe(const CLI::App& command, const Glossaries& glossaries, std::string& text) {
  for (const CLI::App* subcommand : subcommands(command)) describe(*subcommand, glossaries, text);
  if (command.get_parent() == nullptr || !subcommands(command).empty()) return;
  text += ".SS " + roff(usage(command)) + "\n" + roff(command.get_description()) + ".\n";
  for (const CLI::Option* positional : positionals(command)) text += option_text(*positional);
  for (const CLI::Option* option : options(command)) {
    if (option != command.get_help_ptr()) text += option_text(*option);
  }
  text += ".PP\nExamples:\n" + example_text(command);
  const auto found = glossaries.find(&command);
  if (found == glossaries.end()) return;
  for (const auto& [title, words] : found->second) {
    text += ".PP\n" + roff(title) + ":\n";
    for (const auto& [name, meaning] : words) text += tagged(name, meaning + (meaning.ends_with('.') ? "" : "."));
  }
}

std::string manual_section(const std::string& title, const std::vector<Manual::Entry>& entries) {
  if (entries.empty()) return {};
  std::string text = ".SH " + title + "\n";
  for (const auto& [name, meaning] : entries) text += tagged(name, meaning);
  return text;
}

std::string exit_statuses(const std::vector<int>& known) {
  std::vector<Manual::Entry> entries;
  for (const auto& [status, meaning] : kExitMeanings) {
    if (std::ranges::find(known, status) != known.end()) entries.emplace_back(std::to_string(status), std::string(meaning) + ".");
  }
  return manual_section("EXIT STATUS", entries);
}

std::string see_also(const std::vector<std::pair<std::string, int>>& pages) {
  std::string text = ".SH SEE ALSO\n";
  for (const auto& [name, number] : pages) {
    text += ".BR " + roff(name) + " (" + std::to_string(number) + (name == pages.back().first ? ")\n" : "),\n");
  }
  return text;
}

}  // namespace

std::string manual_page(const CommandLine& line) {
  const std::string& program = line.program.name;
  std::string capitals = program;
  std::ranges::transform(capitals, capitals.begin(), [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  std::string text = ".TH " + roff(capitals) + " 1 \"\" \"" + program + " " + line.program.version + "\" \"User Commands\"\n";
  text += ".SH NAME\n" + program + " \\- " + line.manual.summary + "\n";
  text += ".SH SYNOPSIS\n.B " + program + "\n[\\fIOPTIONS\\fR] ";
  text += needs_command(line.app) ? "\\fICOMMAND\\fR [\\fIARGUMENTS\\fR]\n" : "[\\fICOMMAND\\fR [\\fIARGUMENTS\\fR]]\n";
  text += ".SH DESCRIPTION\n" + line.manual.description + "\n";
  text += "Results are written to standard output, all other messages to standard error.\n";
  text += ".SH EXAMPLES\n" + example_text(line.app);
  text += ".SH COMMANDS\n";
  describe(line.app, line.glossaries, text);
  text += ".SH OPTIONS\nThese options may be given before or after the command.\n";
  for (const CLI::Option* option : options(line.app)) text += option_text(*option);
  text += manual_section("ENVIRONMENT", line.manual.environment) + exit_statuses(line.manual.exit_statuses) + line.manual.further_sections;
  return text + manual_section("FILES", line.manual.files) + see_also(line.manual.see_also);
}

int print_manual(const CommandLine& line, Console& console) {
  console.out << manual_page(line) << std::flush;
  if (console.is_out_terminal) print_hint(console, "to read the manual: " + line.program.name + " man | man -l -");
  return kOk;
}

}  // namespace dts::cli
