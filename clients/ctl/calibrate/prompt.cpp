// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/prompt.h"

#include <poll.h>
#include <unistd.h>

#include <charconv>
#include <iostream>

namespace dts::ctl {
namespace {

/// Returns the number in "r 13".
std::optional<std::size_t> redo_number(const std::string& line) {
  if (!line.starts_with("r ")) return std::nullopt;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(line.data() + 2, line.data() + line.size(), number);
  if (error != std::errc{} || end != line.data() + line.size() || number == 0) return std::nullopt;
  return number;
}

}  // namespace

Reply Prompt::ask(const std::string& question, std::string_view choices) const {
  const bool has_all = choices == kWithAll;
  while (true) {
    talk_ << question << choices << std::flush;
    const auto line = read_line_();
    if (!line) {
      talk_ << '\n';
      return {Answer::Quit};
    }
    if (line->empty()) return {Answer::Go};
    if (*line == "r" && (has_all || choices == kWithRedo)) return {Answer::Redo};
    if (const auto number = redo_number(*line); number && has_all) return {Answer::Redo, number};
    if (*line == "s" && has_all) return {Answer::Skip};
    if (*line == "q") return {Answer::Quit};
    talk_ << "  '" << (line->size() < 20 ? *line : line->substr(0, 20)) << "' is not an answer here\n";
  }
}

std::optional<Answer> Prompt::poll() const {
  while (is_typed_ && is_typed_()) {
    const auto line = read_line_();
    if (!line || *line == "q") return Answer::Quit;
    if (*line == "s") return Answer::Skip;
  }
  return std::nullopt;
}

Prompt::ReadLine standard_input() {
  return []() -> std::optional<std::string> {
    std::string line;
    if (!std::getline(std::cin, line)) return std::nullopt;
    return line;
  };
}

bool has_standard_input() {
  if (std::cin.rdbuf()->in_avail() > 0) return true;
  pollfd item{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return ::poll(&item, 1, 0) > 0;
}

bool is_input_terminal() noexcept { return ::isatty(STDIN_FILENO) == 1; }

}  // namespace dts::ctl
