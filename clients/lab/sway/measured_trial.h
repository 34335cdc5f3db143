// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posturography/analysis.h"

namespace dts::lab::sway {

using Labels = std::vector<std::pair<std::string, std::string>>;  ///< eyes=open, surface=firm

/// One trial of quiet standing from a CSV file or a recording, and its measures.
struct MeasuredTrial {
  std::string file;
  std::string session;      ///< Empty: unknown. The same applies to the next fields.
  std::string subject;      ///< Subject ID.
  std::uint32_t trial = 0;  ///< 0: none, in a CSV file or in a recording without trials.
  std::uint32_t attempt = 1;
  std::uint32_t stretch = 0;  ///< Number of the stretch in which a person stands, in a recording without trials; 0: there is only one.
  std::string condition;
  std::string outcome;  ///< "done", "redone", ...; empty: no trial.
  Labels labels;
  std::optional<posturography::Analysis> analysis;
  std::string problem;  ///< Why there is no analysis.
  /// Whether dtsd recorded the same result. Empty if dtsd recorded none, or if another definition was requested.
  std::optional<bool> is_as_recorded;

  [[nodiscard]] std::string label(const std::string& name) const;
  /// Returns a title for people: "standing.csv", "session.xdf, trial 3 (eyes=open)".
  [[nodiscard]] std::string title() const;
};

}  // namespace dts::lab::sway
