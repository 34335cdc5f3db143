// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace dts::ctl {

/// Options of `dtsctl calibrate` only, checked for syntax and range.
struct CalibrateArguments {
  double hold_s = 3.0;  ///< How long a load or gap must be steady; the mean is computed over this time.
  std::string out;      ///< Empty: a name from rig and date.
  bool is_auto = false;

  std::string sensor;           ///< Label, or "all".
  std::vector<double> gaps_mm;  ///< In the order of measurement.
  std::string points_file;      ///< If not empty: readings from this file, no measurement.

  // If absent: as in the interrupted calibration, or the default.
  std::optional<std::string> estimator;
  std::vector<double> loads_n;
  std::optional<std::size_t> grid;
  std::optional<std::size_t> verify;
  bool is_resumed = false;
  bool is_fresh = false;
};

}  // namespace dts::ctl
