// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dts::lab::steadiness {

/// What `dtslab sway` is told.
struct SwayArguments {
  std::vector<std::string> inputs;  ///< Files and folders.
  std::string profile = "lp10";
  std::optional<double> rate_hz;  ///< Of analysis; absent: CSV files as sampled, recordings by the report's definition.
  double trim_s = 0.0;
  std::optional<double> foot_length_mm;
  std::vector<std::string> labels;    ///< "eyes=open": for all inputs; "eyes=open,closed": one for each.
  std::vector<std::uint32_t> trials;  ///< Of recordings; empty: all.
  bool is_all = false;                ///< Redone and rejected trials too.
  bool is_comparing = false;
  std::string table;  ///< CSV to write; empty: none.
};

/// What `dtslab steadiness` is told.
struct SteadinessArguments {
  std::string table;  ///< Written by `dtslab sway --table`.
  std::string label;  ///< The column to be told from measures.
  std::vector<std::string> measures;
  std::string model;
  std::string out;
};

}  // namespace dts::lab::steadiness
