// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::ctl {

/// Erases the `lines` lines drawn last and reads the terminal's size. If the terminal was resized since, it has wrapped the lines again and
/// their number is unknown: then the whole screen is erased.
void erase(cli::Console& console, std::size_t lines);

/// Lines on a terminal that replace the lines drawn before, as many as fit; the first one is bold. Long lines are wrapped.
class Screen {
 public:
  explicit Screen(cli::Console& console) : console_(console) {}

  /// Erases the lines and returns the number of columns.
  [[nodiscard]] std::size_t clear();
  void draw(const std::vector<std::string>& lines);
  /// Keeps the drawn lines; the next ones are drawn below them.
  void make_room() noexcept { drawn_ = 0; }

 private:
  cli::Console& console_;
  std::size_t drawn_ = 0;
};

}  // namespace dts::ctl
