// SPDX-License-Identifier: Apache-2.0
#include "device/bytes/command_line.h"

namespace dts::device::bytes {

core::Result<std::vector<std::string>> split_command(std::string_view command) {
  std::vector<std::string> words;
  bool is_in_word = false;
  char quote = '\0';
  for (const char c : command) {
    if (quote != '\0') {
      if (c == quote) {
        quote = '\0';
      } else {
        words.back() += c;
      }
      continue;
    }
    if (c == ' ' || c == '\t') {
      is_in_word = false;
      continue;
    }
    if (!is_in_word) words.emplace_back();
    is_in_word = true;
    if (c == '\'' || c == '"') {
      quote = c;
    } else {
      words.back() += c;
    }
  }
  const auto refuse = [&](const char* why) {
    return core::fail(core::ErrorCode::InvalidArgument, "command \"" + std::string(command) + "\": " + why,
                      "write exec:PROGRAM ARGUMENT..., for example exec:/usr/bin/python3 /etc/dtsd/board.py");
  };
  if (quote != '\0') return refuse("a quote is not closed");
  if (words.empty() || words.front().empty()) return refuse("names no program");
  return words;
}

}  // namespace dts::device::bytes
