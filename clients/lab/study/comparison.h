// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/study/experiments.h"

namespace dts::lab::study {

/// One figure of the study in all draws of people, with what the thesis prints for real ones.
struct ComparedFigure {
  std::string name;              ///< "nn1_healthy_correct"
  std::string sentence;          ///< For people.
  int of = 0;                    ///< A count out of so many; 0: no count.
  std::optional<double> thesis;  ///< By the rows of its table, where these and the total disagree.
  std::vector<double> ours;      ///< One per draw; NaN where undefined.

  [[nodiscard]] double least() const;
  [[nodiscard]] double median() const;
  [[nodiscard]] double most() const;
};

[[nodiscard]] std::vector<ComparedFigure> compare(const std::vector<Draw>& draws);

/// What must be known of these figures.
[[nodiscard]] std::vector<std::string> study_notes();

}  // namespace dts::lab::study
