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

inline constexpr double kPatienceS = 10.0;  ///< After this time the program prints again what is still moving.

/// Settings of a measurement.
struct MeasureOptions {
  std::vector<std::string> labels;  ///< Of the channels, for messages.
  std::string unit;
  SteadyLimits limits;
  std::uint8_t refused_quality = 0;                                 ///< Bits of v1::Quality that make a hold invalid.
  std::size_t patience_scans = 1000;                                ///< After this many scans it prints again what is still moving.
  std::function<void(const std::string&)> say;                      ///< Prints one line of talk.
  std::function<std::string(std::span<const double> scan)> sees{};  ///< Describes a scan; may be empty.
  std::function<std::string(const std::string& label, std::uint8_t quality)> advise{};  ///< Advice on a quality bit; may be empty.
  std::function<bool()> is_stopped{};  ///< Returns true if the person wants to stop measuring; may be empty.
};

/// Returns the number of scans in a hold. Fails with InvalidArgument if there are fewer than `kLeastWindowScans`.
[[nodiscard]] client::Result<std::size_t> hold_scans(double hold_s, double rate_hz);

/// Waits until the load or the spacers are steady, and measures them. A hold is never averaged if scans are missing, if quality bits are
/// set or if it ends too early: it starts again, and the talk explains why.
class Measurer {
 public:
  using Test = std::function<bool(std::span<const double> scan)>;

  Measurer(Feed& feed, MeasureOptions options);

  /// Returns the mean over the first steady hold in which every scan passes `is_there`; nothing if the person stopped it. Fails only as the
  /// feed does.
  [[nodiscard]] client::Result<std::optional<SteadyReading>> measure(const Test& is_there);
  /// Returns when `is_gone` is true for three scans in a row. Ignores scans that have quality bits, are not finite or follow a loss.
  [[nodiscard]] client::Result<void> wait_until(const Test& is_gone);
  /// Drops the scans received before this call.
  [[nodiscard]] client::Result<void> begin_anew();

 private:
  void add(const FeedBlock& block, const Test& is_there);
  void spoil(const std::string& why);
  /// Returns the first quality problem, in words, and keeps advice about it.
  [[nodiscard]] std::string doubts(const FeedBlock& block);
  /// Counts a hold spoilt by a quality problem; prints advice after several in a row.
  void count_doubt(const std::string& doubt);
  [[nodiscard]] bool is_patience_over(std::size_t scans);
  void say_unrest(std::size_t scans);
  [[nodiscard]] std::string seen(const std::string& otherwise) const;

  Feed& feed_;
  MeasureOptions options_;
  SteadyDetector detector_;
  std::vector<double> scan_;
  bool has_begun_ = false;  ///< A hold is in progress.
  std::string reported_;    ///< The last reason printed; a repeated reason is not printed again.
  std::size_t waited_scans_ = 0;
  std::string doubt_;              ///< Quality problem of the last block; empty: none.
  std::string advice_;             ///< What to do about `doubt_`.
  std::string doubted_;            ///< The quality problem that spoilt the last hold.
  std::size_t doubted_holds_ = 0;  ///< Number of such holds in a row.
};

}  // namespace dts::ctl
