// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/reach.h"
#include "lab/reach/trial_set.h"

namespace dts::accuracy {

/// What is known of a trial of the development set.
struct ReachTruth {
  std::string subject;
  double trial = 0.0;
  double rate_hz = 100.0;
  std::string condition;
  double trunk_deg = 0.0;
  double t1_s = 0.0;
  double t2_s = 0.0;
  double t3_s = 0.0;
  double p1_mm = 0.0;
  double p2_mm = 0.0;
  double p3_mm = 0.0;
};

/// trials.csv of `folder`, in its order; empty when it cannot be read.
[[nodiscard]] std::vector<ReachTruth> read_truth(const std::string& folder);

/// How the found reaches of some trials compare with the truth.
struct ReachScores {
  std::size_t trials = 0;
  std::size_t found = 0;
  double p1_in_time = 0.0;  ///< Part of the found ones within 0.1 s.
  double p2_in_time = 0.0;
  double p3_in_time = 0.0;
  double p3_close = 0.0;  ///< Part whose P3 is within 5 % of the swing.
  double d1_median_error_mm = 0.0;
  double d2_median_error_mm = 0.0;
  std::size_t gross = 0;  ///< d2 wrong by more than half.
  std::size_t minor = 0;
  double latest_s = 0.0;  ///< Final after P3.
};

/// Trial k is counted when `is_counted[k]`.
[[nodiscard]] ReachScores score(const std::vector<ReachTruth>& truth, const std::vector<std::optional<core::ReachEvent>>& reaches,
                                const std::vector<bool>& is_counted);

/// One line of a Markdown table, and its head.
[[nodiscard]] std::string table_head();
[[nodiscard]] std::string table_row(const std::string& name, const ReachScores& scores);

}  // namespace dts::accuracy
