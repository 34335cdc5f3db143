// SPDX-License-Identifier: Apache-2.0
#include "ctl/screen.h"

#include <algorithm>
#include <string_view>

#include "cli/table.h"

namespace dts::ctl {
namespace {

constexpr std::string_view kWrapIndent = "  ";

}  // namespace

void erase(cli::Console& console, std::size_t lines) {
  const std::size_t columns = console.columns;
  console.measure(console);
  if (lines == 0) return;
  if (console.columns != columns) {
    console.out << "\x1b[H\x1b[J";  // to the top, then clear to the end of the screen
  } else {
    console.out << "\x1b[" << lines << "A\x1b[J";  // up, then clear to the end of the screen
  }
}

std::size_t Screen::clear() {
  erase(console_, drawn_);
  drawn_ = 0;
  return console_.columns;
}

void Screen::draw(const std::vector<std::string>& lines) {
  std::ignore = clear();
  // The cursor cannot move above the screen, and it is below the last line.
  const std::size_t room = std::max<std::size_t>(console_.lines, 2) - 1;
  for (std::size_t index = 0; index < lines.size(); ++index) {
    for (const std::string& line : cli::wrapped(cli::printable(lines[index]), console_.columns, kWrapIndent)) {
      if (drawn_ == room) break;
      console_.out << cli::styled(console_, index == 0 ? cli::Style::Bold : cli::Style::Plain, line) << '\n';
      ++drawn_;
    }
  }
  console_.out.flush();
}

}  // namespace dts::ctl
