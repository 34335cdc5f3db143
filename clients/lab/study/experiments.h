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

/// One network of the thesis and its answers for each group, one confusion per volunteer.
struct NetworkResult {
  std::size_t trained_on = 0;  ///< Number of reaches.
  double own_r = kUnknown;     ///< Correlation of outputs and targets on its own data (thesis Fig. 5.8).
  std::vector<Confusion> teachers;
  std::vector<Confusion> healthy;
  std::vector<Confusion> stroke;
};

/// Results of models trained without the volunteer.
struct LeftOutFigures {
  std::vector<Confusion> answers;  ///< One per volunteer, nothing rejected.
  Confusion kept;                  ///< All volunteers, with rejection.
  Confusion kept_by_angle;         ///< As `kept`, but only targets beyond the arm's reach, against the class of the true trunk angle.
  double calibration_error = kUnknown;
  double angle_rms_deg = kUnknown;
  double angle_coverage = kUnknown;  ///< Of 90 % intervals computed from the other volunteers.
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
  NetworkResult nn1;              ///< Trained on natural reaches of A to C (135).
  NetworkResult nn2_one_pace;     ///< Trained on ideal reaches of A to C at the thesis's pace (45).
  NetworkResult nn2;              ///< The same at four paces (180).
  RecommendedResult recommended;  ///< Leave-one-subject-out.
  RecommendedResult invented;     ///< By a model of 160 invented people, like the model shipped with dtsd.
};

struct StudyOptions {
  std::uint64_t seed = 1;
  std::size_t draws = 5;
  bool has_healthy = true;  ///< H1 to H10; false: their results stay empty. The same applies to the next two.
  bool has_stroke = true;
  bool has_recommended = true;  ///< Needs `has_healthy`.
};

inline constexpr std::array<double, 1> kThesisPaces = {0.75};
inline constexpr std::array<double, 4> kPaces = {0.75, 1.0, 1.25, 1.5};  ///< reach-model section 6.
inline constexpr std::size_t kInventedPeople = 160;                      ///< As `dtslab reach train --simulated`.
inline constexpr int kInventedTrials = 6;
inline constexpr int kIdealRepetitions = 5;  ///< Thesis 5.4.3.

/// Fails if reaches cannot be simulated or networks cannot be trained.
[[nodiscard]] core::Result<std::vector<Draw>> run_study(const StudyOptions& options, const Progress& progress);

/// Returns the sum over a group.
[[nodiscard]] Confusion sum(const std::vector<Confusion>& all);

/// Returns the median draw by the correct answers of both networks over all groups, so that the shown draw is neither lucky nor unlucky.
/// `draws` must not be empty.
[[nodiscard]] const Draw& middle_draw(const std::vector<Draw>& draws);

}  // namespace dts::lab::study
