// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/sway/sway_arguments.h"

namespace dts::lab {

/// Everything that the command line can say, checked for syntax and range.
struct Arguments {
  bool is_json = false;
  std::string plot;  ///< File for a picture; empty: none.

  std::string case_file;
  std::optional<std::string> method;
  std::optional<int> divisions;
  bool is_nonlinear = false;

  std::string table;  ///< Of the thesis.

  std::string rig;          ///< Rig file; empty: the thesis's floor platform.
  std::string points;       ///< CSV of point loads.
  std::string calibration;  ///< TOML.
  std::string estimator = "poly3";
  std::string noise = "none";
  std::string contact = "points";  ///< Or "one-foot", "two-feet".
  bool is_linear = false;          ///< Thin-plate theory alone.
  std::vector<double> loads_n;
  std::string out;

  std::string first;  ///< Recording to replay, or the first of those to compare.
  std::string second;

  std::size_t sensor_count = 4;

  std::string speed = "max";  ///< Of a replay.

  std::string kind;  ///< Of rig to simulate: "floor", "chair".
  double duration_s = 0.0;
  std::optional<double> rate_hz;  ///< Absent: the rig's.
  std::uint32_t seed = 1;
  std::string truth;  ///< CSV to write.

  std::string folder;                 ///< Of reaching trials.
  std::string model;                  ///< Of trunk movement.
  std::string net = "recommended";    ///< Or "raw5".
  std::vector<std::string> subjects;  ///< To train on; empty: all healthy ones.
  bool has_simulated_people = false;  ///< Train on simulated people too, or alone.
  bool is_recorded_only = false;      ///< Train without simulated people.
  bool is_rejecting = true;           ///< Doubtful reaches get no class.
  std::string calibrate;              ///< "max:3": each subject's first three trials at that target; empty: none.

  steadiness::SwayArguments sway;
  steadiness::SteadinessArguments steadiness;
};

}  // namespace dts::lab
