// SPDX-License-Identifier: Apache-2.0
#include "ctl/screen.h"

#include <algorithm>

namespace dts::ctl {

std::string cut(const std::string& text, std::size_t columns) {
  std::size_t bytes = 0;
  for (std::size_t shown = 0; bytes < text.size(); ++bytes) {
    const bool is_start = (static_cast<unsigned char>(text[bytes]) & 0xC0U) != 0x80U;
    if (is_start && ++shown > columns) break;
  }
  return text.substr(0, bytes);
}

void Screen::draw(const std::vector<std::string>& lines) {
  if (drawn_ > 0) console_.out << "\x1b[" << drawn_ << "A\x1b[J";  // up, then clear to the end
  // The cursor cannot go back above the screen, and stands below the last line.
  drawn_ = std::min(lines.size(), std::max<std::size_t>(console_.lines, 2) - 1);
  for (std::size_t index = 0; index < drawn_; ++index) {
    const std::string line = cut(cli::printable(lines[index]), console_.columns);
    console_.out << cli::styled(console_, index == 0 ? cli::Style::Bold : cli::Style::Plain, line) << '\n';
  }
  console_.out.flush();
}

}  // namespace dts::ctl
