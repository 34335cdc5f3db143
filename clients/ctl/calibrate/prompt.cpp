// SPDX-License-Identifier: Apache-2.0
#include "ctl/calibrate/prompt.h"

#include <unistd.h>

#include <iostream>

namespace dts::ctl {

Answer Prompt::ask(const std::string& question, std::string_view choices) const {
  while (true) {
    talk_ << question << choices << std::flush;
    const auto line = read_line_();
    if (!line) {
      talk_ << '\n';
      return Answer::Quit;
    }
    if (line->empty()) return Answer::Go;
    if (*line == "r" && choices == kWithRedo) return Answer::Redo;
    if (*line == "q") return Answer::Quit;
    talk_ << "  '" << (line->size() < 20 ? *line : line->substr(0, 20)) << "' means nothing here\n";
  }
}

Prompt::ReadLine standard_input() {
  return []() -> std::optional<std::string> {
    std::string line;
    if (!std::getline(std::cin, line)) return std::nullopt;
    return line;
  };
}

bool is_input_terminal() noexcept { return ::isatty(STDIN_FILENO) == 1; }

}  // namespace dts::ctl
