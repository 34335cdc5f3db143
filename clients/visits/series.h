// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dts/v1/sessions.pb.h"

namespace dts::visits {

/// A result of one session.
struct Point {
  std::string session_id;
  std::int64_t utc_ns = 0;  ///< Start of the session.
  double value = 0.0;
  std::optional<double> spread{};      ///< Standard deviation over its trials; absent: one trial, or not known.
  std::uint32_t trials = 0;            ///< Trials or reaches that the value is computed from; 0: not known.
  std::optional<double> duration_s{};  ///< Of its trials; absent: not known, or trials of different lengths.
  bool is_comparable = true;           ///< Like the newest point: same filter, rate, duration, target, reaching arm and scale of angles.
};

/// A measure over the visits of a subject, always of the same rig, protocol and condition.
struct Series {
  std::string rig;
  std::string protocol;
  std::string condition;  ///< "eyes-open", "romberg/feet=two", "120"; empty: of the whole session.
  std::string measure;    ///< "MVELO", "trunk_mean_deg"
  std::string unit;
  std::vector<Point> points{};  ///< Oldest first.
};

/// Returns all series of a subject's sessions, sorted by rig, protocol, condition and measure. Leaves out deleted and running sessions.
/// Measures of the chair's targets are read from the details of the result "targets":
/// trunk_mean_deg, trunk_sd_deg (deg), d2_mean_mm (mm), and trunk_class: the median class of its reaches, 0 (none) to 3 (maximum).
/// Of a resumed session: see session_of_one_part.
[[nodiscard]] std::vector<Series> series_of(const v1::SubjectRecord& subject);

/// Returns the session with the results of one part only, named as if it had no other: the part with most trials, the newest of equals. The
/// results of a part do not count the trials of another one, and a part that a crash ended may have none.
[[nodiscard]] v1::SessionRecord session_of_one_part(const v1::SessionRecord& session);

/// Returns the newest point and the others of a series that can be compared with it, oldest first.
[[nodiscard]] std::vector<Point> comparable_points(const Series& series);

}  // namespace dts::visits
