// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/rate.h"
#include "pipeline/reach/state_exchange.h"

namespace dts::pipeline {

/// A sample of the transient for the detection of reaches: at 100 Hz, averaged over 50 ms.
struct ReachSample {
  double mm = 0.0;
  double ratio = 0.0;
  double twist = 0.0;
  bool is_known = false;  ///< false: the sensors had no valid value for some time.
  bool is_substituted = false;
  bool is_at_end = false;  ///< A sensor was at the end of its range.
  bool is_untared = false;
};

/// Converts scans of any rate to `ReachSample`s: block means at 100 Hz, or the nearest rate that divides the scan rate, then a moving
/// average over 50 ms (reach-model section 5). The thesis's window of three scans is 30 ms at 100 Hz but 2 ms at 1500 Hz; here, windows
/// have fixed durations. Missing values are replaced by the last one for up to 250 ms.
class Smoother {
 public:
  static constexpr double kRateHz = 100.0;
  static constexpr std::size_t kWindow = 5;
  static constexpr std::size_t kStateSize = 11 + kWindow * 6;

  void prepare(const core::Rate& rate) noexcept;
  /// Scans per sample.
  [[nodiscard]] std::uint64_t divisor() const noexcept { return divisor_; }
  /// Delay from the middle of a sample's window to the scan that completes the sample.
  [[nodiscard]] std::uint64_t delay_scans() const noexcept { return (divisor_ * kWindow) / 2; }
  /// Adds one scan; returns true if it completes `sample()`. Realtime-safe: yes.
  bool add(double mm, double ratio, double twist, std::uint8_t bits) noexcept;
  [[nodiscard]] const ReachSample& sample() const noexcept { return sample_; }
  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  struct Entry {
    double mm = 0.0;
    double ratio = 0.0;
    double twist = 0.0;
    bool is_substituted = false;
    bool is_at_end = false;
    bool is_untared = false;
  };
  template <class Self, class Archive>
  static void exchange(Self& self, Archive& archive) noexcept;
  [[nodiscard]] bool finish_block() noexcept;

  std::uint64_t divisor_ = 1;
  std::uint64_t bridged_limit_ = 1;

  double sum_mm_ = 0.0;
  double sum_ratio_ = 0.0;
  double sum_twist_ = 0.0;
  std::uint64_t scans_ = 0;  ///< Scans in the current block ...
  std::uint64_t known_ = 0;  ///< ... and how many of them have a value.
  std::uint64_t substituted_ = 0;
  std::uint64_t at_end_ = 0;
  bool is_untared_ = false;

  std::array<Entry, kWindow> window_{};
  std::size_t next_ = 0;
  std::uint64_t bridged_ = 0;  ///< Blocks in a row without a value.
  std::size_t filled_ = 0;
  ReachSample sample_;
};

}  // namespace dts::pipeline
