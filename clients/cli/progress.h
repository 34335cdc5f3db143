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

/// A bar for work that lasts longer than two seconds: on a terminal only, on `talk`, in one line that is removed at the end.
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

  /// Sets how much is done, 0..1. Draws at most ten times per second.
  void report(double fraction);
  /// Draws the last reported value; draws nothing during the first two seconds.
  void tick();
  /// Starts a thread that calls `tick`: for work that reports nothing for seconds. The work must not write to `talk` until this object
  /// ends.
  void tick_by_itself();

 private:
  void draw();  ///< Requires that `mutex_` is held.

  Console& console_;
  std::string what_;
  std::function<Time()> now_;
  std::mutex mutex_;  ///< Protects all members below, and the drawing.
  std::condition_variable_any end_;
  Time begun_;
  Time drawn_;
  double fraction_ = 0.0;
  std::size_t columns_drawn_ = 0;
  std::jthread ticker_;  ///< Must be the last member: it uses the others.
};

}  // namespace dts::cli
