// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/force/standing_cop.h"

namespace dts::lab::sway {

/// Arguments of `dtslab sway`.
struct SwayArguments {
  std::vector<std::string> inputs;  ///< Files and folders.
  std::string profile = "lp10";
  std::optional<double> rate_hz;  ///< Rate of analysis; absent: CSV files as sampled, recordings with the definition of the report.
  double trim_s = 0.0;
  std::optional<double> foot_length_mm;
  std::vector<std::string> labels;    ///< "eyes=open": one value for all inputs; "eyes=open,closed": one value per input.
  std::vector<std::uint32_t> trials;  ///< Of recordings; empty: all.
  bool is_all = false;                ///< Includes redone and rejected trials.
  bool is_comparing = false;
  std::string table;     ///< CSV to write; empty: none.
  force::CopChoice cop;  ///< Of files of force plates.
  bool is_json = false;
};

}  // namespace dts::lab::sway
