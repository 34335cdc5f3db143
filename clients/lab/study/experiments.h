// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "core/result.h"
#include "lab/study/confusion.h"
#include "lab/study/study_reaches.h"

namespace dts::lab::study {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One network of the thesis and what it says of each group, one confusion per volunteer.
struct NetworkResult {
  std::size_t trained_on = 0;  ///< Reaches.
  double own_r = kUnknown;     ///< Correlation of outputs and targets on its own data (thesis Fig. 5.8).
  std::vector<Confusion> teachers;
  std::vector<Confusion> healthy;
  std::vector<Confusion> stroke;
};

/// Judged by a model that never saw the volunteer.
struct LeftOutFigures {
  std::vector<Confusion> answers;  ///< One per volunteer, nothing rejected.
  Confusion kept;                  ///< All volunteers, with rejection.
  Confusion kept_by_angle;         ///< The same beyond the arm's reach, against the class of what the trunk truly did.
  double calibration_error = kUnknown;
  double angle_rms_deg = kUnknown;
  double angle_coverage = kUnknown;  ///< Of 90 % intervals made from the other volunteers.
};

/// The recommended model on A to C and H1 to H10.
struct RecommendedResult {
  std::vector<std::string> names;
  LeftOutFigures general;
  LeftOutFigures own;  ///< With the volunteer's own first three maximum reaches as a scale.
};

/// The thesis's experiments with one draw of people.
struct Draw {
  std::uint64_t seed = 1;
  NetworkResult nn1;              ///< Taught by natural reaches of A to C (135).
  NetworkResult nn2_one_pace;     ///< Taught by ideal ones of A to C at the thesis's pace (45).
  NetworkResult nn2;              ///< The same at four paces (180).
  RecommendedResult recommended;  ///< Leave-one-subject-out.
  RecommendedResult invented;     ///< By a model of 60 invented people, as the one that dtsd ships.
};

struct StudyOptions {
  std::uint64_t seed = 1;
  std::size_t draws = 5;
  bool has_healthy = true;  ///< H1 to H10; false: these stay empty, as do those below.
  bool has_stroke = true;
  bool has_recommended = true;  ///< Needs the healthy.
};

inline constexpr std::array<double, 1> kThesisPaces = {0.75};
inline constexpr std::array<double, 4> kPaces = {0.75, 1.0, 1.25, 1.5};  ///< reach-model section 6.
inline constexpr std::size_t kInventedPeople = 60;                       ///< As `dtslab reach train --simulated`.
inline constexpr int kInventedTrials = 10;
inline constexpr int kIdealRepetitions = 5;  ///< Thesis 5.4.3.

/// Fails when reaches cannot be simulated or networks cannot be trained.
[[nodiscard]] core::Result<std::vector<Draw>> run_study(const StudyOptions& options, const Progress& progress);

/// All of a group.
[[nodiscard]] Confusion sum(const std::vector<Confusion>& all);

/// The draw in the middle by what both networks get right of all groups, to show one that is neither lucky nor unlucky. Not empty.
[[nodiscard]] const Draw& middle_draw(const std::vector<Draw>& draws);

}  // namespace dts::lab::study
