// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/units.h"

namespace dts::core {

/// Doubts about one reach, as bits. Recordings store them: never change a number.
namespace reach_flag {
inline constexpr std::uint16_t kMinor = 1U << 0;              ///< d2 is below 5 % of P1: only the arm moved, or the posture shifted.
inline constexpr std::uint16_t kBaselineUncertain = 1U << 1;  ///< No rest before the reach: the session's baseline is used instead.
inline constexpr std::uint16_t kDipOnly = 1U << 2;            ///< The load fell but did not rise: a shift of posture.
inline constexpr std::uint16_t kTimeout = 1U << 3;            ///< The load did not return to rest in time.
inline constexpr std::uint16_t kResumed = 1U << 4;            ///< The reach continued after a pause: a sub-movement, or a second reach.
inline constexpr std::uint16_t kSubstituted = 1U << 5;        ///< The value of a bad sensor was estimated from the change of the others.
inline constexpr std::uint16_t kSaturated = 1U << 6;          ///< A sensor reached the end of its range.
inline constexpr std::uint16_t kImplausible = 1U << 7;        ///< The sensors contradict each other: swapped, shifted or loose.
inline constexpr std::uint16_t kStoodUp = 1U << 8;            ///< The person left the seat before the reach ended.
inline constexpr std::uint16_t kUntared = 1U << 9;            ///< No tare: the levels are not those of this chair.
inline constexpr std::uint16_t kNoInitiation = 1U << 10;      ///< No dip before the rise: P2 equals P1.
}  // namespace reach_flag

enum class ReachStep : std::uint8_t {
  P1 = 1,     ///< Provisional: the reach has begun.
  P2,         ///< Provisional: the reach initiation stage has ended.
  P3,         ///< Provisional: the transient has stopped rising; a higher one may follow.
  Final,      ///< P1, P2, P3 and all features are final. If the reach continues, a later Final with the same number replaces this one.
  Cancelled,  ///< Not a reach: earlier events with this number are void.
};

/// A point of the transient (thesis Fig. 5.6).
struct ReachPoint {
  ScanIndex scan;  ///< Scan of the rig's raw stream; the delay of all filters is subtracted.
  double value_mm = std::numeric_limits<double>::quiet_NaN();

  friend bool operator==(const ReachPoint&, const ReachPoint&) = default;
};

/// Features of the transient of a reach: thesis 5.3.3 (d1, d2, P1, P2, P3) and the additions of reach-model section 6. Before Final,
/// unknown features are NaN.
struct ReachFeatures {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double p1_mm = kUnknown;
  double p2_mm = kUnknown;
  double p3_mm = kUnknown;
  double hold_mm = kUnknown;       ///< Mean of the values above P2 + 0.8 (P3 - P2), minus P1.
  double rise_s = kUnknown;        ///< From P2 to P3.
  double rest_ratio = kUnknown;    ///< R before the reach: (front - rear) / mean of the valid sensors; independent of the person's weight.
  double ratio_change = kUnknown;  ///< R at P3 minus R before the reach: monotone in the centre of pressure.
  double twist = kUnknown;         ///< Before the reach: ((rear left - rear right) - (front left - front right)) / mean; near 0.
  double smoothness = kUnknown;    ///< Spectral arc length from P1 to P3, dimensionless, <= 0; closer to 0 is smoother.

  [[nodiscard]] double d1_mm() const noexcept { return p1_mm - p2_mm; }
  [[nodiscard]] double d2_mm() const noexcept { return p3_mm - p1_mm; }
};

/// Published by the stage `reach`.
struct ReachEvent {
  ReachStep step = ReachStep::P1;
  std::uint32_t number = 0;  ///< Number of the reach in its segment, from 1.
  std::uint32_t segment = 0;
  ScanIndex scan;                 ///< Scan at which the stage found the step; the step itself was earlier.
  std::int64_t host_time_ns = 0;  ///< Host time of that scan.
  ReachPoint p1;
  ReachPoint p2;
  ReachPoint p3;
  ReachFeatures features;
  std::uint16_t flags = 0;
  std::uint16_t resumed = 0;  ///< How often the reach continued after a pause.
};

/// Degree of trunk bending, as in conditions 1 to 3 of the thesis (Fig. 5.3).
enum class TrunkClass : std::int8_t {
  Rejected = -1,  ///< The model is not sure enough, or the reach cannot be judged.
  None = 0,       ///< No trunk movement: only the arm moved.
  Minor = 1,
  Moderate = 2,
  Maximum = 3,
};

/// Why a reach was rejected, or what limits its class.
namespace class_reason {
inline constexpr std::uint16_t kUnsure = 1U << 0;        ///< The most probable class is below the model's limit.
inline constexpr std::uint16_t kOutOfRange = 1U << 1;    ///< A feature is outside the training data of the model.
inline constexpr std::uint16_t kBadReach = 1U << 2;      ///< The reach is doubtful: see its flags.
inline constexpr std::uint16_t kMinor = 1U << 3;         ///< A minor reach gets at most class 1.
inline constexpr std::uint16_t kCalibrated = 1U << 4;    ///< Calibrated with the subject's own maximum reaches.
inline constexpr std::uint16_t kDisagreement = 1U << 5;  ///< Class and angle contradict each other, or the networks contradict each other.
}  // namespace class_reason

/// The result of a model for one reach. Thread: any.
struct TrunkMovement {
  TrunkClass trunk_class = TrunkClass::Rejected;
  std::array<double, 3> probability{};                             ///< Of classes 1, 2 and 3, also for a rejected reach; sums to 1.
  double trunk_deg = std::numeric_limits<double>::quiet_NaN();     ///< Flexion at P3; NaN: the model has no angle.
  double trunk_lo_deg = std::numeric_limits<double>::quiet_NaN();  ///< Limits of the 90 % interval.
  double trunk_hi_deg = std::numeric_limits<double>::quiet_NaN();
  std::uint16_t reasons = 0;
};

/// Published by the stage `classify` right after the Final with the same number.
struct ClassEvent {
  std::uint32_t number = 0;
  std::uint32_t segment = 0;
  ScanIndex scan;
  std::int64_t host_time_ns = 0;
  TrunkMovement movement;
};

}  // namespace dts::core
