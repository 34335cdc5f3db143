// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::ctl {

/// Erases the `lines` lines drawn last and reads the terminal's size. A terminal that was resized since has wrapped them anew, nobody
/// knows into how many: then everything on it is erased.
void erase(cli::Console& console, std::size_t lines);

/// Lines on a terminal that are drawn over those drawn before, as many as there is room for, the first one bold. Too long ones are wrapped.
class Screen {
 public:
  explicit Screen(cli::Console& console) : console_(console) {}

  /// Makes room for new lines and returns how many columns they have.
  [[nodiscard]] std::size_t clear();
  void draw(const std::vector<std::string>& lines);
  /// What stands there stays; the next lines are drawn below.
  void make_room() noexcept { drawn_ = 0; }

 private:
  cli::Console& console_;
  std::size_t drawn_ = 0;
};

}  // namespace dts::ctl
