// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include "cli/documents.h"
#include "cli/exit_status.h"
#include "core/join.h"

namespace dts::cli {
namespace {

using Candidate = std::pair<std::string, std::string>;  ///< Word and description.

/// Collects `command` and every command below it, as "path of words" (" session start").
void collect(const CLI::App& command, const std::string& path, std::vector<std::pair<std::string, const CLI::App*>>& found) {
  found.emplace_back(path, &command);
  for (const CLI::App* subcommand : subcommands(command)) collect(*subcommand, path + " " + subcommand->get_name(), found);
}

void add_options(const CLI::App& command, std::vector<Candidate>& words) {
  for (const CLI::Option* option : options(command)) {
    for (const std::string& name : option->get_lnames()) words.emplace_back("--" + name, option->get_description());
  }
}

/// Returns the words that may follow `command`.
std::vector<Candidate> candidates(const CLI::App& command, const CLI::App& root) {
  std::vector<Candidate> words;
  for (const CLI::App* subcommand : subcommands(command)) words.emplace_back(subcommand->get_name(), subcommand->get_description());
  if (command.get_name() == "completion") words = {{"bash", "for bash"}, {"zsh", "for zsh"}};
  add_options(command, words);
  if (&command == &root) return words;
  std::vector<Candidate> globals;
  add_options(root, globals);
  std::erase_if(globals, [](const Candidate& word) { return word.first == "--help" || word.first == "--version"; });
  words.insert(words.end(), globals.begin(), globals.end());
  return words;
}

std::string shell_quoted(const std::string& text) {
  std::string safe = "'";
  for (const char letter : text) safe += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return safe + "'";
}

/// Returns the pattern of the `case` that recognises commands: " rig list"|" rig show"
std::string patterns(const std::vector<std::pair<std::string, const CLI::App*>>& commands) {
  std::string text;
  for (const auto& [path, command] : commands) {
    if (!path.empty()) text += (text.empty() ? "" : "|") + shell_quoted(path);
  }
  return text;
}

}  // namespace

std::string bash_completion(const CommandLine& line) {
  const std::string& program = line.program.name;
  std::vector<std::pair<std::string, const CLI::App*>> commands;
  collect(line.app, "", commands);
  std::string text = "# bash completion for " + program + "; made by '" + program + " completion bash'\n_" + program +
                     "() {\n"
                     "  local command='' words='' index\n"
                     "  for ((index = 1; index < COMP_CWORD; index++)); do\n"
                     "    case \"$command ${COMP_WORDS[index]}\" in\n"
                     "      " +
                     patterns(commands) +
                     ") command=\"$command ${COMP_WORDS[index]}\" ;;\n"
                     "    esac\n"
                     "  done\n"
                     "  case \"$command\" in\n";
  for (const auto& [path, command] : commands) {
    const std::string words = core::join(candidates(*command, line.app), " ", [](const auto& candidate) { return candidate.first; });
    text += "    " + shell_quoted(path) + ") words=" + shell_quoted(words) + " ;;\n";
  }
  const std::string fallback = line.program.takes_files ? "-o default " : "";
  return text +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"${COMP_WORDS[COMP_CWORD]}\"))\n"
         "}\n"
         "complete " +
         fallback + "-F _" + program + " " + program + "\n";
}

std::string zsh_completion(const CommandLine& line) {
  const std::string& program = line.program.name;
  std::vector<std::pair<std::string, const CLI::App*>> commands;
  collect(line.app, "", commands);
  std::string text = "#compdef " + program + "\n# zsh completion for " + program + "; made by '" + program + " completion zsh'\n_" +
                     program +
                     "() {\n"
                     "  local command='' word\n"
                     "  local -a candidates\n"
                     "  for word in ${words[2,CURRENT-1]}; do\n"
                     "    case \"$command $word\" in\n"
                     "      (" +
                     patterns(commands) +
                     ") command=\"$command $word\" ;;\n"
                     "    esac\n"
                     "  done\n"
                     "  case \"$command\" in\n";
  for (const auto& [path, command] : commands) {
    text += "    (" + shell_quoted(path) + ") candidates=(";
    for (const auto& [word, description] : candidates(*command, line.app)) {
      std::string entry = word;
      entry.append(":").append(description);
      text.append("\n      ").append(shell_quoted(entry));
    }
    text += ") ;;\n";
  }
  const std::string fallback = line.program.takes_files ? " || _files" : "";
  return text +
         "  esac\n"
         "  _describe -o " +
         program + " candidates" + fallback +
         "\n"
         "}\n"
         "_" +
         program + " \"$@\"\n";
}

int print_completion(const CommandLine& line, Console& console) {
  console.out << (line.shell == "zsh" ? zsh_completion(line) : bash_completion(line)) << std::flush;
  return kOk;
}

}  // namespace dts::cli
