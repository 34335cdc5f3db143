// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// A pulse that one recording has and the other lacks.
struct PulseFault {
  enum class Kind { LostInA, LostInB, ExtraInA, ExtraInB };

  Kind kind = Kind::LostInA;
  double time_s = 0.0;  ///< On A's clock.
};

/// Maps B's clock to A's clock: t_a = t_b + offset + drift (t_b - reference).
struct Alignment {
  enum class Means { PulseTrain, Trigger, Marker, Correlation };

  /// After a gap a clock may have jumped: from this time on B's clock, the offset differs by `shift_s`.
  struct Piece {
    double from_s = 0.0;
    double shift_s = 0.0;      ///< NaN: unknown, because nothing aligns this piece.
    double shift_sd_s = 0.0;   ///< 0 for the piece that `offset_s` is for.
    double reference_s = 0.0;  ///< On B's clock, in the middle of the piece's data.
    double sd_s = 0.0;         ///< Standard deviation of `to_a_s` at that time.
  };

  Means means = Means::Correlation;
  double offset_s = 0.0;                                        ///< At `reference_s`.
  double offset_sd_s = 0.0;                                     ///< Standard deviation.
  double drift_ppm = std::numeric_limits<double>::quiet_NaN();  ///< NaN: unknown with a single event; counts as 0.
  double drift_sd_ppm = std::numeric_limits<double>::quiet_NaN();
  double reference_s = 0.0;                                            ///< On B's clock, in the middle of the used data.
  std::vector<Piece> pieces{};                                         ///< Rising; empty: no clock restarted.
  std::size_t event_count = 0;                                         ///< Common pulses, triggers or markers.
  std::size_t window_count = 0;                                        ///< Windows of the signals; correlation of long recordings only.
  double period_s = std::numeric_limits<double>::quiet_NaN();          ///< Pulse train only.
  std::vector<PulseFault> faults{};                                    ///< Pulse train only.
  double peak_correlation = std::numeric_limits<double>::quiet_NaN();  ///< Correlation only.
  bool is_refined_by_signals = false;                                  ///< Pulse train only: the signals narrowed the offset down.
  bool is_drift_by_signals = false;                                    ///< The events are too few to show it.
  std::string warning;  ///< Why existing events were not used, or what contradicts; empty: no warning.

  /// Returns NaN in a piece that nothing aligns.
  [[nodiscard]] double to_a_s(double t_b_s) const noexcept;
  /// Returns the standard deviation of `to_a_s`; NaN in a piece that nothing aligns.
  [[nodiscard]] double sd_at_s(double t_b_s) const noexcept;
};

/// "pulse train", "trigger", "marker", "correlation"
[[nodiscard]] std::string_view name(Alignment::Means means) noexcept;

/// Below this value, similarity may be chance: any two recordings have some similar part.
inline constexpr double kLeastCorrelation = 0.3;

/// Aligns by a pulse train if both recordings have one, else by trigger edges that both recordings have, else by equal markers, else by
/// cross-correlation of both axes, refined by least squares in offset, drift, and gain and mean per axis. A single pair of events, two
/// pairs of three or more, and events that match in several ways are accepted only if the signals are similar. Otherwise, and if less than
/// half of the events match, uses the signals and sets a warning. Ignores, with a warning, more than 500 triggers that are no pulse train.
/// Fails with Failed if nothing matches, and with LimitExceeded for more than 500 markers.
[[nodiscard]] core::Result<Alignment> align(const Recording& a, const Recording& b);

// The parts of `align`.

/// Returns the alignment by equal markers; nothing if they may match by chance or in more than one way.
[[nodiscard]] std::optional<Alignment> align_by_markers(const Recording& a, const Recording& b);
[[nodiscard]] core::Result<Alignment> align_by_correlation(const Recording& a, const Recording& b);

/// The restarts of both clocks, each on its own clock. They divide the recordings into pieces.
class Restarts {
 public:
  Restarts(const Recording& a, const Recording& b) : a_s_(a.restarts_s), b_s_(b.restarts_s) {}

  [[nodiscard]] std::size_t piece_count() const noexcept { return a_s_.size() + b_s_.size() + 1; }
  /// Returns the piece of a moment, from its times on both clocks.
  [[nodiscard]] std::size_t piece_at(double a_s, double b_s) const noexcept;
  /// Returns where each piece but the first begins on B's clock, rising. `late_s`: A's reading minus B's in each piece; NaN: unknown.
  [[nodiscard]] std::vector<double> starts_on_b_s(const std::vector<double>& late_s) const;

 private:
  std::vector<double> a_s_;
  std::vector<double> b_s_;
};

}  // namespace dts::lab::compare
