// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posturography/cop_series.h"
#include "session/figure.h"
#include "session/sway_results.h"

namespace dts::session {

/// Returns the mean load of a trial in N; nothing if no sample has one.
[[nodiscard]] std::optional<double> mean_load_n(const posturography::CopSeries& cop);

/// The load of a session's subject on a rig that corrects for two feet.
struct StandingLoad {
  double mean_n = 0.0;
  std::size_t trials = 0;
  double stance_width_mm = 0.0;       ///< Stated; 0: unknown, and the load is approximate.
  std::optional<double> stated_kg{};  ///< The field weight_kg: only a check.

  [[nodiscard]] double mass_kg() const noexcept;
  /// Returns whether the stated weight differs so much that the stated width or weight must be wrong.
  [[nodiscard]] bool is_doubtful() const noexcept;
  /// Returns "about 64 kg, corrected for two feet without a stance width", with the doubt if there is one.
  [[nodiscard]] std::string sentence() const;
};

/// Returns the mean over the valid trials that are not on one foot; nothing if none of them has a load. `fields`: of the session.
[[nodiscard]] std::optional<StandingLoad> standing_load(const std::vector<SwayTrialResult>& trials,
                                                        const std::vector<std::pair<std::string, std::string>>& fields);
/// Returns the result "load_n"; the sentence is "note" in its details.
[[nodiscard]] SessionFigure to_figure(const StandingLoad& load);

}  // namespace dts::session
