// SPDX-License-Identifier: Apache-2.0
#include "cli/run.h"

#include <CLI/Error.hpp>
#include <algorithm>
#include <streambuf>

#include "cli/exit_status.h"
#include "cli/json.h"
#include "cli/suggestion.h"
#include "core/result.h"

namespace dts::cli {
namespace {

struct UsageError {
  std::string what;
  std::string hint;
};

/// Returns the command that the words selected before an error; the root if none.
const CLI::App& reached(const CLI::App& command) {
  const auto chosen = command.get_subcommands();
  return chosen.empty() ? command : reached(*chosen.back());
}

void add_long_names(const CLI::App& command, std::vector<std::string>& names) {
  for (const CLI::Option* option : options(command)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  if (command.get_parent() != nullptr) add_long_names(*command.get_parent(), names);
}

/// Returns the name at `command` that is most similar to `word`; empty if none is.
std::string meant(const std::string& word, const CLI::App& command) {
  std::vector<std::string> names;
  if (word.starts_with('-')) {
    add_long_names(command, names);
  } else {
    for (const CLI::App* subcommand : subcommands(command)) names.push_back(subcommand->get_name());
  }
  return nearest(word.substr(0, word.find('=')), names);
}

/// Returns "session start: "; empty for the program itself, because the line already names it.
std::string prefix(const CLI::App& command) {
  return command.get_parent() == nullptr ? "" : full_name(command).substr(root_of(command).get_name().size() + 1) + ": ";
}

UsageError unexpected_word(const std::string& word, const CLI::App& command) {
  const bool is_group = !subcommands(command).empty();
  const char* kind = word.starts_with('-') ? "option" : is_group ? "command" : "argument";
  if (word == "help" && is_group) return {prefix(command) + "unexpected command 'help'", full_name(command) + " --help"};
  const std::string near = meant(word, command);
  std::string hint = near.empty() ? full_name(command) + " --help" : "did you mean " + near + "? " + full_name(command) + " --help";
  if (near.empty() && !is_group && !word.starts_with('-') && !positionals(command).empty()) hint = "put several words in quotes; " + hint;
  return {prefix(command) + "unexpected " + kind + " '" + word + "'", hint};
}

/// Reports a key that no option has: CLI11 reports "INI was not able to parse KEY" for files of any format.
UsageError unknown_key(const CLI::App& root, const CLI::ConfigError& error) {
  const std::string text = error.what();
  const std::string start = "INI was not able to parse ";
  const std::string what = text.starts_with(start) ? "unknown key '" + text.substr(start.size()) + "'" : text;
  return {"configuration file: " + what, full_name(root) + " --help"};
}

/// Returns one text for every kind of parse error in CLI11.
UsageError usage_error(const CLI::App& root, const CLI::ParseError& error) {
  if (const auto* wrong_file = dynamic_cast<const CLI::ConfigError*>(&error)) return unknown_key(root, *wrong_file);
  const CLI::App& command = reached(root);
  // CLI11 first reports a misspelt command as a missing one.
  const std::vector<std::string> left_over = root.remaining(true);
  if (!left_over.empty()) return unexpected_word(left_over.front(), command);
  const std::string help = full_name(command) + " --help";
  if (needs_command(command)) {
    const std::string names = join(subcommands(command), ", ", [](const CLI::App* subcommand) { return subcommand->get_name(); });
    return {prefix(command) + "a command is missing", "give one of: " + names + "; " + help};
  }
  return {prefix(command) + error.what(), help};
}

/// Forwards everything written to `out`, and records whether anything was written. Restores `out` at the end.
class Witness final : public std::streambuf {
 public:
  explicit Witness(std::ostream& out) : out_(out), behind_(out.rdbuf()) { put(this); }
  ~Witness() override { put(behind_); }
  Witness(const Witness&) = delete;
  Witness& operator=(const Witness&) = delete;

  [[nodiscard]] bool has_seen_text() const noexcept { return has_seen_text_; }

 protected:
  int_type overflow(int_type letter) override {
    if (traits_type::eq_int_type(letter, traits_type::eof())) return traits_type::not_eof(letter);
    has_seen_text_ = true;
    return behind_->sputc(traits_type::to_char_type(letter));
  }
  std::streamsize xsputn(const char* text, std::streamsize size) override {
    has_seen_text_ = has_seen_text_ || size > 0;
    return behind_->sputn(text, size);
  }
  int sync() override { return behind_->pubsync(); }

 private:
  /// Keeps the error state: a new buffer clears it, and a full disk would then look like success.
  void put(std::streambuf* buffer) {
    const auto state = out_.rdstate();
    out_.rdbuf(buffer);
    out_.setstate(state);
  }

  std::ostream& out_;
  std::streambuf* behind_;
  bool has_seen_text_ = false;
};

/// Returns {"error": {"code": "not_found", "message": ..., "hint": ...}}.
Json error_json(const Failure& failure, int status) {
  const int code = failure.code != 0 ? failure.code : status;
  Json error{{"code", core::name(static_cast<core::ErrorCode>(code))}, {"message", failure.what}};
  if (!failure.hint.empty()) error["hint"] = failure.hint;
  return {{"error", std::move(error)}};
}

int run_words(CommandLine& line, const std::vector<std::string>& arguments, Console& console) {
  try {
    line.app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 expects the words in reverse order
  } catch (const CLI::CallForHelp&) {
    console.out << line.app.help() << std::flush;
    return kOk;
  } catch (const CLI::CallForVersion&) {
    console.out << line.app.version() << std::endl;
    return kOk;
  } catch (const CLI::ParseError& error) {
    const UsageError wrong = usage_error(line.app, error);
    print_error(console, wrong.what, wrong.hint);
    return kUsage;
  }
  return line.handlers.at(&reached(line.app))(console);
}

}  // namespace

int run(CommandLine& line, const std::vector<std::string>& arguments, Console& console) {
  console.program = line.program.name;
  console.failure.reset();
  if (std::ranges::find(arguments, "--json") == arguments.end()) return run_words(line, arguments, console);
  const Witness witness(console.out);
  const int status = run_words(line, arguments, console);
  // If a result was already written, a second document would break the output. After Ctrl-C, an error printed before is not the reason for
  // the end.
  if (status != kOk && status != kInterrupted && console.failure && !witness.has_seen_text()) {
    console.out << document(error_json(*console.failure, status)) << std::flush;
  }
  return status;
}

}  // namespace dts::cli
