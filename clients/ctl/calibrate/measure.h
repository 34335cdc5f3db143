// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "ctl/calibrate/feed.h"
#include "ctl/calibrate/steady.h"
#include "dts/error.h"

namespace dts::ctl {

/// What a measurement needs to know about its channels.
struct MeasureOptions {
  std::vector<std::string> labels;  ///< Of the channels, for messages.
  std::string unit;
  SteadyLimits limits;
  std::uint8_t refused_quality = 0;             ///< Bits of v1::Quality that spoil a hold.
  std::size_t patience_scans = 1000;            ///< Says after so many scans again what is still moving.
  std::function<void(const std::string&)> say;  ///< One line of talk.
};

/// Scans of a hold; fails with InvalidArgument when they are fewer than `kLeastWindowScans`.
[[nodiscard]] client::Result<std::size_t> hold_scans(double hold_s, double rate_hz);

/// Waits for things to rest on the plate or before the sensors, and measures them. A hold that scans are missing from, that the
/// quality bits doubt or that ends too early is never averaged: it begins anew, and the talk says why.
class Measurer {
 public:
  using Test = std::function<bool(std::span<const double> scan)>;

  Measurer(Feed& feed, MeasureOptions options);

  /// The mean over the first steady hold of which every scan passes `is_there`. Fails only as the feed does.
  [[nodiscard]] client::Result<SteadyReading> measure(const Test& is_there);
  /// Returns when `is_gone` holds for three scans in a row.
  [[nodiscard]] client::Result<void> wait_until(const Test& is_gone);
  /// What was measured while nobody asked is forgotten.
  [[nodiscard]] client::Result<void> begin_anew();

 private:
  void take(const FeedBlock& block, const Test& is_there);
  void spoil(const std::string& why);
  [[nodiscard]] std::string doubts(const FeedBlock& block) const;
  void say_unrest(std::size_t scans);

  Feed& feed_;
  MeasureOptions options_;
  SteadyDetector detector_;
  std::vector<double> scan_;
  bool has_begun_ = false;  ///< A hold is under way.
  std::string told_;        ///< The last reason told; each is told once in a row.
  std::size_t waited_scans_ = 0;
};

}  // namespace dts::ctl
