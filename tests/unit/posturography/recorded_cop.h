// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "posturography/cop_series.h"

namespace dts::posturography::test {

/// A recording of a real person from beside the checkout; nothing where there is none.
inline std::optional<CopSeries> recorded_cop(std::string_view name) {
  std::ifstream file(std::string(DTS_SOURCE_DIR) + "/../shared/data/cop/" + std::string(name));
  if (!file) return std::nullopt;
  std::vector<double> t_s;
  std::vector<double> ml_mm;
  std::vector<double> ap_mm;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    double t = 0.0;
    double x = 0.0;
    double y = 0.0;
    char comma = ',';
    cells >> t >> comma >> x >> comma >> y;
    t_s.push_back(t);
    ml_mm.push_back(x);
    ap_mm.push_back(y);
  }
  auto series = even_series(t_s, ml_mm, ap_mm);
  if (!series) return std::nullopt;
  return *series;
}

}  // namespace dts::posturography::test
