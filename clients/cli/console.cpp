// SPDX-License-Identifier: Apache-2.0
#include "cli/console.h"

namespace dts::cli {
namespace {

std::string_view escape_sequence(Style style) {
  switch (style) {
    case Style::Plain: return "";
    case Style::Bold: return "\x1b[1m";
    case Style::Good: return "\x1b[32m";
    case Style::Warning: return "\x1b[33m";
    case Style::Bad: return "\x1b[31m";
    case Style::Faint: return "\x1b[2m";
  }
  return "";
}

}  // namespace

std::string styled(const Console& console, Style style, std::string_view text) {
  if (!console.has_colours || style == Style::Plain) return std::string(text);
  return std::string(escape_sequence(style)).append(text).append("\x1b[0m");
}

void print_error(Console& console, std::string_view what, std::string_view hint) {
  console.talk << console.program << ": " << printable(what) << '\n';
  if (!hint.empty()) console.talk << "  try: " << printable(hint) << '\n';
  console.talk.flush();
  console.failure = Failure{std::string(what), std::string(hint)};
}

void print_hint(Console& console, std::string_view text) {
  if (console.is_talk_terminal) console.talk << text << std::endl;
}

}  // namespace dts::cli
