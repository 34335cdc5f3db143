// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "cli/console.h"

namespace dts::ctl {

/// The first `columns` columns of UTF-8 text.
[[nodiscard]] std::string cut(const std::string& text, std::size_t columns);

/// Lines on a terminal that are drawn over those drawn before: as many and as long as there is room, the first one bold.
class Screen {
 public:
  explicit Screen(cli::Console& console) : console_(console) {}

  void draw(const std::vector<std::string>& lines);
  /// What stands there stays; the next lines are drawn below.
  void make_room() noexcept { drawn_ = 0; }

 private:
  cli::Console& console_;
  std::size_t drawn_ = 0;
};

}  // namespace dts::ctl
