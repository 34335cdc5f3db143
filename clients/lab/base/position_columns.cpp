// SPDX-License-Identifier: Apache-2.0
#include "lab/base/position_columns.h"

#include <algorithm>
#include <array>
#include <utility>

namespace dts::lab {
namespace {

constexpr std::array<std::pair<const char*, const char*>, 2> kPairs{{{"x_mm", "y_mm"}, {"ml_mm", "ap_mm"}}};

}  // namespace

void add_position_columns(std::vector<CsvColumn>& columns) {
  constexpr double kMostMm = 1e6;
  for (const auto& [ml, ap] : kPairs) {
    for (const char* const name : {ml, ap}) {
      columns.push_back({.name = name, .is_required = false, .may_be_empty = true, .minimum = -kMostMm, .maximum = kMostMm});
    }
  }
}

bool has_position_columns(std::span<const std::string_view> names) {
  const auto has = [names](const char* name) { return std::ranges::find(names, name) != names.end(); };
  return std::ranges::any_of(kPairs, [&](const auto& pair) { return has(pair.first) && has(pair.second); });
}

std::optional<PositionColumns> position_columns(const std::string& file, const CsvTable& table, files::Problems& problems) {
  for (const auto& [ml, ap] : kPairs) {
    if (table.has(ml) && table.has(ap)) return PositionColumns{ml, ap};
  }
  for (const auto& [name, meaning] :
       {std::pair{"x_mm", "ML, positive to the subject's right; or ml_mm"}, std::pair{"y_mm", "AP, positive forward; or ap_mm"}}) {
    if (!table.has(name)) problems.push_back({file, 1, 1, "column '" + std::string(name) + "' is missing (" + meaning + ")"});
  }
  return std::nullopt;
}

}  // namespace dts::lab
