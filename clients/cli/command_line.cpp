// SPDX-License-Identifier: Apache-2.0
#include "cli/command_line.h"

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <memory>
#include <sstream>

#include "cli/documents.h"
#include "cli/exit_status.h"
#include "cli/help_formatter.h"

namespace dts::cli {
namespace {

/// Parses lines of "left | right".
std::vector<std::pair<std::string, std::string>> pairs_of(const std::string& text) {
  std::vector<std::pair<std::string, std::string>> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t bar = line.rfind(" | ");
    if (bar != std::string::npos) found.emplace_back(line.substr(0, bar), line.substr(bar + 3));
  }
  return found;
}

}  // namespace

CommandLine::CommandLine(Program about) : program(std::move(about)) {
  app.name(program.name);
  app.description(program.description);
  app.footer(program.examples);
  app.formatter(std::make_shared<HelpFormatter>(glossaries));
  app.set_help_flag("-h,--help", "Print this help");
  app.fallthrough();
  app.require_subcommand(1);
}

CLI::App* add_group(CLI::App& parent, const std::string& name, const std::string& description, const std::string& examples) {
  CLI::App* group = parent.add_subcommand(name, description);
  group->footer(examples);
  group->require_subcommand(1);
  return group;
}

CLI::App* add_command(CommandLine& line, CLI::App& parent, const std::string& name, const std::string& description,
                      const std::string& examples, Handler handler) {
  CLI::App* command = parent.add_subcommand(name, description);
  command->footer(examples);
  line.handlers.emplace(command, std::move(handler));
  return command;
}

void run_without_command(CommandLine& line, Handler handler) {
  line.app.require_subcommand(0, 1);
  line.handlers.emplace(&line.app, std::move(handler));
}

void add_common(CommandLine& line) {
  const std::string& name = line.program.name;
  line.app.set_version_flag("--version", name + " " + line.program.version, "Print the version");
  CLI::App* completion = add_command(line, line.app, "completion", "Print the completion script of a shell",
                                     name + " completion bash > ~/.local/share/bash-completion/completions/" + name + " | for bash\n" +
                                         name + " completion zsh > ~/.zfunc/_" + name + " | for zsh, with ~/.zfunc in fpath\n",
                                     [&line](Console& console) { return print_completion(line, console); });
  completion->add_option("SHELL", line.shell, "bash or zsh")->required()->option_text(" ")->check(CLI::IsMember({"bash", "zsh"}));
  add_command(line, line.app, "man", "Print the manual page", name + " man | man -l - | read it\n",
              [&line](Console& console) { return print_manual(line, console); });
}

std::vector<Example> examples(const CLI::App& command) {
  std::vector<Example> found;
  for (auto& [line, purpose] : pairs_of(command.get_footer())) found.push_back({std::move(line), std::move(purpose)});
  return found;
}

void explain(CommandLine& line, const CLI::App& command, const std::string& words) {
  line.glossaries[&command].push_back({.title = "Output", .words = pairs_of(words)});
}

std::vector<const CLI::App*> subcommands(const CLI::App& command) { return command.get_subcommands({}); }

std::vector<const CLI::Option*> options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->nonpositional(); });
}

std::vector<const CLI::Option*> positionals(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::string option_label(const CLI::Option& option) {
  if (option.get_positional()) return option.get_name();
  const std::string names = option.get_name(false, true);
  return option.get_items_expected_max() == 0 ? names : names + " " + option.get_option_text();
}

std::string full_name(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name() : full_name(*command.get_parent()) + " " + command.get_name();
}

bool needs_command(const CLI::App& command) { return command.get_require_subcommand_min() > 0; }

std::string usage(const CLI::App& command) {
  std::string text = full_name(command);
  if (needs_command(command)) return text + " COMMAND";
  for (const CLI::Option* option : options(command)) {
    if (option->get_required()) text += " " + option_label(*option);
  }
  text += " [OPTIONS]";
  for (const CLI::Option* positional : positionals(command)) {
    const std::string& name = positional->get_name();
    text += positional->get_required() ? " " + name : " [" + name + " ...]";
  }
  return text;
}

const CLI::App& root_of(const CLI::App& command) { return command.get_parent() == nullptr ? command : root_of(*command.get_parent()); }

}  // namespace dts::cli
