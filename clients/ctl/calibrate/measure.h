// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "ctl/calibrate/feed.h"
#include "ctl/calibrate/steady.h"
#include "dts/error.h"

namespace dts::ctl {

inline constexpr double kPatienceS = 10.0;  ///< Then it is said again what is still moving.

/// What a measurement needs to know about its channels.
struct MeasureOptions {
  std::vector<std::string> labels;  ///< Of the channels, for messages.
  std::string unit;
  SteadyLimits limits;
  std::uint8_t refused_quality = 0;                                 ///< Bits of v1::Quality that spoil a hold.
  std::size_t patience_scans = 1000;                                ///< Says after so many scans again what is still moving.
  std::function<void(const std::string&)> say;                      ///< One line of talk.
  std::function<std::string(std::span<const double> scan)> sees{};  ///< What a scan looks like; may be empty.
  std::function<std::string(const std::string& label, std::uint8_t quality)> advise{};  ///< What to do about a doubt; may be empty.
  std::function<bool()> is_stopped{};  ///< The person wants to do something else; may be empty.
};

/// Scans of a hold; fails with InvalidArgument when they are fewer than `kLeastWindowScans`.
[[nodiscard]] client::Result<std::size_t> hold_scans(double hold_s, double rate_hz);

/// Waits for things to rest on the plate or before the sensors, and measures them. A hold that scans are missing from, that the
/// quality bits doubt or that ends too early is never averaged: it begins anew, and the talk says why.
class Measurer {
 public:
  using Test = std::function<bool(std::span<const double> scan)>;

  Measurer(Feed& feed, MeasureOptions options);

  /// The mean over the first steady hold of which every scan passes `is_there`; nothing when the person stopped it. Fails only as the
  /// feed does.
  [[nodiscard]] client::Result<std::optional<SteadyReading>> measure(const Test& is_there);
  /// Returns when `is_gone` holds for three scans in a row. Scans that are doubtful, not finite or behind a loss tell nothing.
  [[nodiscard]] client::Result<void> wait_until(const Test& is_gone);
  /// What was measured while nobody asked is forgotten.
  [[nodiscard]] client::Result<void> begin_anew();

 private:
  void take(const FeedBlock& block, const Test& is_there);
  void spoil(const std::string& why);
  /// The first doubt, in words; remembers what it means.
  [[nodiscard]] std::string doubts(const FeedBlock& block);
  /// Takes note of a doubtful hold; tells what it means when it comes again and again.
  void count_doubt(const std::string& doubt);
  [[nodiscard]] bool is_patience_over(std::size_t scans);
  void say_unrest(std::size_t scans);
  [[nodiscard]] std::string seen(const std::string& otherwise) const;

  Feed& feed_;
  MeasureOptions options_;
  SteadyDetector detector_;
  std::vector<double> scan_;
  bool has_begun_ = false;  ///< A hold is under way.
  std::string told_;        ///< The last reason told; each is told once in a row.
  std::size_t waited_scans_ = 0;
  std::string doubt_;              ///< Of the last block; empty: none.
  std::string advice_;             ///< What `doubt_` means.
  std::string doubted_;            ///< The doubt that spoilt the last hold.
  std::size_t doubted_holds_ = 0;  ///< So many in a row.
};

}  // namespace dts::ctl
