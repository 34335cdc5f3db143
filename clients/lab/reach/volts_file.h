// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "files/toml_reader.h"

namespace dts::lab::reach {

/// The volts of four sensors, trial by trial: columns trial, v1, v2, v3, v4, one row per scan.
class VoltsFile {
 public:
  using Volts = std::vector<std::array<double, 4>>;

  /// Adds every error to `problems` with file:line:column, including a trial whose rows are not contiguous.
  [[nodiscard]] static VoltsFile read(const std::string& file, files::Problems& problems);
  /// Returns nullptr if there is no such trial.
  [[nodiscard]] const Volts* find(std::uint32_t trial) const;

 private:
  std::map<std::uint32_t, Volts> trials_;
};

}  // namespace dts::lab::reach
