// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/study/experiments.h"

namespace dts::lab::study {

/// One figure of the study in all draws of people, and the thesis's value for real people.
struct ComparedFigure {
  std::string name;              ///< "nn1_healthy_correct"
  std::string sentence;          ///< Description for people.
  int of = 0;                    ///< Total of a count; 0: not a count.
  std::optional<double> thesis;  ///< From the rows of its table, if the rows and the printed total disagree.
  std::vector<double> ours;      ///< One per draw; NaN where undefined.

  [[nodiscard]] double least() const;
  [[nodiscard]] double median() const;
  [[nodiscard]] double most() const;
};

[[nodiscard]] std::vector<ComparedFigure> compare(const std::vector<Draw>& draws);

/// Returns notes that are needed to interpret these figures.
[[nodiscard]] std::vector<std::string> study_notes();

}  // namespace dts::lab::study
