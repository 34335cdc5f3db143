// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "core/result.h"
#include "lab/force/force_file.h"

namespace dts::lab::force {

/// Which centre of pressure of a file of force plates is meant, and how the subject stands on it.
struct CopChoice {
  std::string plate = "1";  ///< A number from 1, or "net": all plates together, in the axes of the laboratory.
  std::string ml;           ///< "+x": the axis that points to the subject's right. Empty: not given.
  std::string ap;           ///< The axis that points forward.
  std::string zero = "none";
  double least_force_n = kDefaultLeastForceN;
  std::string plate_file;  ///< For raw channels.
};

/// Adds `--plate`, `--ml`, `--ap`, `--zero`, `--min-force` and `--plate-file`.
void add_cop_choice(CLI::App& command, CopChoice& choice);

/// The centre of pressure of a standing subject: ML positive to the right, AP positive forward. NaN where it is undefined.
struct StandingCop {
  std::vector<double> t_s;
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
  std::vector<double> load_n;  ///< Size of the vertical force; empty: the file has a centre of pressure only.
};

/// Returns whether `read_standing_cop` is to read this file: it holds force plates, or raw channels and there is a
/// plate file for them.
[[nodiscard]] bool has_plates(const std::string& file, const CopChoice& choice);

/// Reads the centre of pressure. Fails with InvalidArgument if the choice does not fit the file, or does not say which axes are ML and AP;
/// otherwise like `read_force_file`.
[[nodiscard]] core::Result<StandingCop> read_standing_cop(const std::string& file, const CopChoice& choice);

}  // namespace dts::lab::force
