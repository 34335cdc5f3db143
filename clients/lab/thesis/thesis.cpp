// SPDX-License-Identifier: Apache-2.0
#include "lab/thesis/thesis.h"

#include <functional>
#include <limits>
#include <utility>

#include "core/join.h"
#include "lab/thesis/thesis_parts.h"

namespace dts::lab::thesis {
namespace {

using Maker = std::function<core::Result<ThesisTable>(const TableProgress&)>;

const std::vector<std::pair<std::string_view, Maker>>& makers() {
  static const std::vector<std::pair<std::string_view, Maker>> known{
      {"3.2", [](const auto&) { return thesis_deflections(false); }},
      {"3.3", [](const auto&) { return thesis_deflections(true); }},
      {"3.4", [](const auto&) { return thesis_proportions(false); }},
      {"3.5", [](const auto&) { return thesis_proportions(true); }},
      {"3.6", [](const auto&) { return thesis_line_errors(); }},
      {"4.1", [](const auto&) { return thesis_loci(); }},
      {"4.2", [](const auto& progress) { return thesis_stack(progress); }},
      {"5.2", [](const auto& progress) { return thesis_teachers(progress); }},
      {"6.2", [](const auto& progress) { return thesis_healthy(progress); }},
      {"6.3", [](const auto&) { return thesis_trunk_angles(); }},
      {"6.4", [](const auto& progress) { return thesis_stroke(progress); }}};
  return known;
}

}  // namespace

const std::vector<std::string_view>& thesis_table_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> all;
    for (const auto& [name, make] : makers()) all.push_back(name);
    return all;
  }();
  return names;
}

core::Result<ThesisTable> thesis_table(std::string_view name, const TableProgress& progress) {
  for (const auto& [one, make] : makers()) {
    if (one == name) return make(progress);
  }
  return core::fail(core::ErrorCode::InvalidArgument, "no thesis table '" + std::string(name) + "'",
                    "one of " + core::join(thesis_table_names()) + ", or all");
}

double deviation_percent(double ours, double printed) noexcept {
  return printed == 0.0 ? std::numeric_limits<double>::quiet_NaN() : 100.0 * (ours - printed) / printed;
}

}  // namespace dts::lab::thesis
