// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dts::ctl {

/// What only `dtsctl calibrate` says, checked for syntax and range.
struct CalibrateArguments {
  double hold_s = 3.0;  ///< How long a load or gap must rest; it is averaged over this time.
  std::string out;      ///< Empty: a name made from rig and date.
  bool is_auto = false;

  std::string sensor;           ///< Label, or "all".
  std::vector<double> gaps_mm;  ///< In the order of measuring.
  std::string points_file;      ///< Not empty: no measuring.

  // Not given: as an interrupted calibration was begun, or the usual ones.
  std::optional<std::string> estimator;
  std::vector<double> loads_n;
  std::optional<std::size_t> grid;
  std::optional<std::size_t> verify;
  bool is_resumed = false;
  bool is_fresh = false;
};

}  // namespace dts::ctl
