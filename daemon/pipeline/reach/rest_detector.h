// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "pipeline/reach/smoother.h"

namespace dts::pipeline {

/// Finds the level at which the transient rests, and its spread there: states SETTLE and QUIET of reach-model section 5.
///
/// Settling ends when a window of 0.6 s is steady and near the session's baseline, the median of the last reaches' baselines. A level that
/// is steady elsewhere for 0.5 s is the plateau of a movement or a new posture: then the session's baseline is used, and `is_uncertain` is
/// true. In Quiet, baseline and spread follow only the older half of the window, so that the beginning of a reach does not change them.
///
/// At the very beginning, a person may rest for only 0.2 s and then move, so that there is no full window. This short rest is used, and is
/// uncertain too.
class RestDetector {
 public:
  static constexpr std::size_t kWindow = 60;  ///< 0.6 s at 100 Hz.
  static constexpr std::size_t kSession = 9;
  static constexpr std::size_t kStateSize = 3 * kWindow + kSession + 14;

  /// Maximum peak-to-peak range of a transient at rest.
  [[nodiscard]] static double steady_mm(double level_mm) noexcept;
  void prepare(double rate_hz) noexcept { rate_hz_ = rate_hz; }
  /// Begins settling; `is_first`: a short rest is enough, because the person has just sat down or the recording has just begun.
  void restart(bool is_first) noexcept;
  /// Forgets the baselines of earlier reaches, because the person's posture has changed.
  void forget_session() noexcept { session_count_ = session_next_ = 0; }
  /// Call while settling; returns true when the rest is found. Realtime-safe: yes.
  bool settle(const ReachSample& sample) noexcept;
  /// Length of the rest that was found, in samples until now.
  [[nodiscard]] std::uint64_t length() const noexcept { return is_short_ ? settling_ : kWindow; }
  /// Call while quiet. Realtime-safe: yes.
  void track(const ReachSample& sample) noexcept;
  /// Adds the current baseline to the session's baselines, because a reach began from it.
  void remember() noexcept;

  [[nodiscard]] double level_mm() const noexcept { return level_mm_; }
  [[nodiscard]] double spread_mm() const noexcept { return spread_mm_; }
  [[nodiscard]] double threshold_mm() const noexcept;
  [[nodiscard]] double ratio() const noexcept { return ratio_; }
  [[nodiscard]] double twist() const noexcept { return twist_; }
  [[nodiscard]] bool is_uncertain() const noexcept { return is_uncertain_ || is_short_; }

  void reset() noexcept;
  void save(StateWriter& writer) const noexcept;
  void restore(StateReader& reader) noexcept;

 private:
  struct Entry {
    double mm = 0.0;
    double ratio = 0.0;
    double twist = 0.0;
  };
  void put(const ReachSample& sample) noexcept;
  [[nodiscard]] static double median_mm(std::span<const Entry> rest) noexcept;
  [[nodiscard]] double session_mm() const noexcept;
  /// Range of the first `filled_` samples.
  [[nodiscard]] double range_mm() const noexcept;
  void begin(double level_mm, std::span<const Entry> rest) noexcept;
  [[nodiscard]] bool settle_shortly(const ReachSample& sample) noexcept;
  template <class Self, class Archive>
  static void exchange(Self& self, Archive& archive) noexcept;

  double rate_hz_ = 100.0;
  std::array<Entry, kWindow> window_{};
  std::size_t next_ = 0;
  std::size_t filled_ = 0;
  std::uint64_t settling_ = 0;   ///< Samples since settling began.
  std::uint64_t calm_ = 0;       ///< How many of them, from the first on, were steady; only used if `is_first_`.
  std::uint64_t elsewhere_ = 0;  ///< Steady samples in a row away from the session's baseline.
  std::array<double, kSession> session_{};
  std::size_t session_next_ = 0;
  std::size_t session_count_ = 0;
  double level_mm_ = 0.0;
  double spread_mm_ = 0.0;
  double ratio_ = 0.0;
  double twist_ = 0.0;
  bool is_first_ = false;
  bool is_short_ = false;  ///< The whole rest was shorter than a window.
  bool is_uncertain_ = false;
};

}  // namespace dts::pipeline
