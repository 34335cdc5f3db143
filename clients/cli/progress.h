// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "cli/console.h"

namespace dts::cli {

/// A bar for work that takes longer than two seconds, on a terminal only, on `talk`, in one line that is removed at the end.
///
///     solving  [############........]  60 %
class Progress {
 public:
  using Time = std::chrono::steady_clock::time_point;

  Progress(Console& console, std::string what, std::function<Time()> now = std::chrono::steady_clock::now);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  Progress(Progress&&) = delete;
  Progress& operator=(Progress&&) = delete;

  /// How much is done, 0..1. Draws at most ten times per second.
  void report(double fraction);

 private:
  Console& console_;
  std::string what_;
  std::function<Time()> now_;
  Time begun_;
  Time drawn_;
  std::size_t columns_drawn_ = 0;
};

}  // namespace dts::cli
