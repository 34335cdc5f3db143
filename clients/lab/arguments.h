// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "lab/sway/sway_arguments.h"

namespace dts::lab {

/// All arguments of the command line, checked for syntax and range.
struct Arguments {
  bool is_json = false;
  std::string plot;  ///< Output file for a picture; empty: none.

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
  bool is_linear = false;          ///< Only thin-plate theory.
  std::vector<double> loads_n;
  std::string out;

  std::string first;  ///< Recording to replay, or the first recording to compare.
  std::string second;

  std::size_t sensor_count = 4;

  std::string speed = "max";  ///< Of a replay.

  std::string kind;  ///< Kind of rig to simulate: "floor", "chair".
  double duration_s = 0.0;
  std::optional<double> rate_hz;  ///< Absent: rate of the rig.
  std::uint32_t seed = 1;
  std::string truth;  ///< CSV to write.

  std::string folder;                 ///< Of reaching trials.
  std::string model;                  ///< Of trunk movement.
  std::string net = "recommended";    ///< Or "raw5".
  std::vector<std::string> subjects;  ///< To train on; empty: all healthy ones.
  bool has_simulated_people = false;  ///< Train also, or only, on simulated people.
  bool is_recorded_only = false;      ///< Train without simulated people.
  bool is_rejecting = true;           ///< Doubtful reaches are rejected.
  std::string calibrate;              ///< "max:3": use each subject's first three trials at that target; empty: none.

  steadiness::SwayArguments sway;
  steadiness::SteadinessArguments steadiness;
};

}  // namespace dts::lab
