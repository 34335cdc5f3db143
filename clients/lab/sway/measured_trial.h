// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posturography/analysis.h"

namespace dts::lab::steadiness {

using Labels = std::vector<std::pair<std::string, std::string>>;  ///< eyes=open, surface=firm

/// One trial of quiet standing, of a CSV file or of a recording, and what was measured.
struct MeasuredTrial {
  std::string file;
  std::string session;      ///< Empty: the file does not say, as below.
  std::string subject;      ///< Pseudonym.
  std::uint32_t trial = 0;  ///< 0: none, of a CSV file or of a recording without trials.
  std::uint32_t attempt = 1;
  std::uint32_t stretch = 0;  ///< Counts the stretches in which somebody stands, of a recording without trials; 0: there is one.
  std::string condition;
  std::string outcome;  ///< "done", "redone", ...; empty: no trial.
  Labels labels;
  std::optional<posturography::Analysis> analysis;
  std::string problem;  ///< Why there is none.
  /// Whether dtsd told the same when it recorded; nothing: it told nothing, or another definition was asked for.
  std::optional<bool> is_as_told;

  [[nodiscard]] std::string label(const std::string& name) const;
  /// "standing.csv", "session.xdf, trial 3 (eyes=open)": for people.
  [[nodiscard]] std::string title() const;
};

}  // namespace dts::lab::steadiness
