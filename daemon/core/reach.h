// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/units.h"

namespace dts::core {

/// Doubts about one reach, as bits: kept in recordings, so numbers stay.
namespace reach_flag {
inline constexpr std::uint16_t kMinor = 1U << 0;              ///< d2 below 5 % of P1: arm alone, or a shift of posture.
inline constexpr std::uint16_t kBaselineUncertain = 1U << 1;  ///< Not at rest before: the session's baseline stands in.
inline constexpr std::uint16_t kDipOnly = 1U << 2;            ///< The load fell and did not rise: a shift of posture.
inline constexpr std::uint16_t kTimeout = 1U << 3;            ///< It never came back.
inline constexpr std::uint16_t kResumed = 1U << 4;            ///< Went on after a pause: a sub-movement, or a second reach.
inline constexpr std::uint16_t kSubstituted = 1U << 5;        ///< A bad sensor was replaced by the change of the others.
inline constexpr std::uint16_t kSaturated = 1U << 6;          ///< A sensor was at the end of its range.
inline constexpr std::uint16_t kImplausible = 1U << 7;        ///< The sensors contradict each other: swapped, shifted or loose.
inline constexpr std::uint16_t kStoodUp = 1U << 8;            ///< The seat was left before the reach was over.
inline constexpr std::uint16_t kUntared = 1U << 9;            ///< Levels are not of this chair: no tare.
inline constexpr std::uint16_t kNoInitiation = 1U << 10;      ///< No dip before the rise: P2 is P1.
}  // namespace reach_flag

enum class ReachStep : std::uint8_t {
  P1 = 1,     ///< Provisional: the reach has begun.
  P2,         ///< Provisional: the reach initiation stage is over.
  P3,         ///< Provisional: the transient has stopped rising; a higher one may follow.
  Final,      ///< P1, P2, P3 and all features stand. Another Final of the same number replaces it: the reach went on.
  Cancelled,  ///< It was no reach: what was told of this number is void.
};

/// A point of the transient (thesis Fig. 5.6).
struct ReachPoint {
  ScanIndex scan;  ///< Of the rig's raw stream, with the delay of all filters taken off.
  double value_mm = std::numeric_limits<double>::quiet_NaN();

  friend bool operator==(const ReachPoint&, const ReachPoint&) = default;
};

/// What the transient says of a reach: thesis 5.3.3 (d1, d2, P1, P2, P3) and what reach-model section 6 adds. All but Final leave
/// what is not known yet NaN.
struct ReachFeatures {
  static constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

  double p1_mm = kUnknown;
  double p2_mm = kUnknown;
  double p3_mm = kUnknown;
  double hold_mm = kUnknown;       ///< Mean while above P2 + 0.8 (P3 - P2), less P1.
  double rise_s = kUnknown;        ///< From P2 to P3.
  double rest_ratio = kUnknown;    ///< R before the reach: (front - rear) / mean of the valid sensors; the weight drops out.
  double ratio_change = kUnknown;  ///< R at P3 less R before: monotone in the centre of pressure.
  double twist = kUnknown;         ///< Before the reach: ((rear left - rear right) - (front left - front right)) / mean; near 0.
  double smoothness = kUnknown;    ///< Of P1 to P3: spectral arc length, dimensionless, <= 0; nearer 0 is smoother.

  [[nodiscard]] double d1_mm() const noexcept { return p1_mm - p2_mm; }
  [[nodiscard]] double d2_mm() const noexcept { return p3_mm - p1_mm; }
};

/// Told by the stage `reach`.
struct ReachEvent {
  ReachStep step = ReachStep::P1;
  std::uint32_t number = 0;  ///< Counts the reaches of a segment, from 1.
  std::uint32_t segment = 0;
  ScanIndex scan;                 ///< At which it was found, not when it happened.
  std::int64_t host_time_ns = 0;  ///< Of that scan.
  ReachPoint p1;
  ReachPoint p2;
  ReachPoint p3;
  ReachFeatures features;
  std::uint16_t flags = 0;
  std::uint16_t resumed = 0;  ///< How often it went on after a pause.
};

/// Degree of trunk bending, as the thesis's conditions 1 to 3 (Fig. 5.3).
enum class TrunkClass : std::int8_t {
  Rejected = -1,  ///< Not sure enough, or not to be judged.
  None = 0,       ///< No trunk movement: the arm alone.
  Minor = 1,
  Moderate = 2,
  Maximum = 3,
};

/// Why a reach was rejected, or what limits the answer.
namespace class_reason {
inline constexpr std::uint16_t kUnsure = 1U << 0;        ///< The most probable class is below the model's limit.
inline constexpr std::uint16_t kOutOfRange = 1U << 1;    ///< A feature is outside what the model was trained on.
inline constexpr std::uint16_t kBadReach = 1U << 2;      ///< The reach itself is doubtful: see its flags.
inline constexpr std::uint16_t kMinor = 1U << 3;         ///< A minor reach is at most class 1.
inline constexpr std::uint16_t kCalibrated = 1U << 4;    ///< By the subject's own maximum reaches.
inline constexpr std::uint16_t kDisagreement = 1U << 5;  ///< Class and angle contradict each other, or the networks do.
}  // namespace class_reason

/// What a model says of one reach. Thread: any.
struct TrunkMovement {
  TrunkClass trunk_class = TrunkClass::Rejected;
  std::array<double, 3> probability{};                             ///< Of classes 1, 2 and 3, also of a rejected reach; sums to 1.
  double trunk_deg = std::numeric_limits<double>::quiet_NaN();     ///< Flexion at P3; NaN: the model gives none.
  double trunk_lo_deg = std::numeric_limits<double>::quiet_NaN();  ///< 90 % interval.
  double trunk_hi_deg = std::numeric_limits<double>::quiet_NaN();
  std::uint16_t reasons = 0;
};

/// Told by the stage `classify` right after the Final of the same number.
struct ClassEvent {
  std::uint32_t number = 0;
  std::uint32_t segment = 0;
  ScanIndex scan;
  std::int64_t host_time_ns = 0;
  TrunkMovement movement;
};

}  // namespace dts::core
