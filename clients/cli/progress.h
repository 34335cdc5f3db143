// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "cli/console.h"

namespace dts::cli {

/// A bar for work that takes longer than two seconds, on a terminal only, on `talk`, in one line that is removed at the end.
///
///     solving  [############........]  60 %  13 s
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
  /// Draws what was reported last; nothing before two seconds are over.
  void tick();
  /// From now on a thread calls `tick`: for work that reports nothing for seconds, and writes nothing to `talk` before this ends.
  void tick_by_itself();

 private:
  void draw();  ///< `mutex_` is held.

  Console& console_;
  std::string what_;
  std::function<Time()> now_;
  std::mutex mutex_;  ///< Over what follows, and over what is drawn.
  std::condition_variable_any end_;
  Time begun_;
  Time drawn_;
  double fraction_ = 0.0;
  std::size_t columns_drawn_ = 0;
  std::jthread ticker_;  ///< Last: it uses all of the above.
};

}  // namespace dts::cli
