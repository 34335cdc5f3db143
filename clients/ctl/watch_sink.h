// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string_view>

#include "dts/stream.h"

namespace dts::ctl {

/// One output format for the messages that `watch` receives.
class WatchSink {
 public:
  using Time = std::chrono::steady_clock::time_point;

  virtual ~WatchSink() = default;
  /// Shows the block's first `scans` scans (1..scan_count).
  virtual void show(const client::Block& block, std::size_t scans, Time now) = 0;
  virtual void show(const client::Event& event) = 0;
  virtual void show(const client::Status& status) = 0;
  /// Returns whether the format shows messages of this topic. Messages that it leaves out do not count for `--count`.
  [[nodiscard]] virtual bool shows(std::string_view /*topic*/) const { return true; }
  /// The daemon was restarted: formats seen so far are invalid.
  virtual void forget() = 0;
  /// Called before other text is written to the terminal.
  virtual void make_room() {}
  /// Called at least ten times per second, also if no messages arrive.
  virtual void refresh(Time now) = 0;
};

}  // namespace dts::ctl
