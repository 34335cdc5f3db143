// SPDX-License-Identifier: Apache-2.0
// Thesis table 6.3: trunk angle for each target.
#include "lab/study/angle_windows.h"
#include "lab/study/volunteers.h"
#include "lab/thesis_parts.h"

namespace dts::lab {
namespace {

void add_window(const std::string& condition, const char* whose, const study::Window& window, Figures& summary) {
  const std::string name = whose + ("_" + condition);
  summary.push_back({name + "_least_deg", window.least_deg});
  summary.push_back({name + "_mean_deg", window.mean_deg});
  summary.push_back({name + "_most_deg", window.most_deg});
}

}  // namespace

core::Result<ThesisTable> thesis_trunk_angles() {
  ThesisTable table{.name = "6.3",
                    .title = "Trunk angle of the healthy volunteers for the three targets",
                    .decimals = 1,
                    .rows = {},
                    .summary = {},
                    .notes = {"Printed: measured with cameras, means of ten reaches. Ours: the angle that a body with these measures needs "
                              "for the distance of the target; "
                              "only the 6 cm of the shoulder are fitted to these volunteers (research sheet, section 3).",
                              "The limits between the classes are halfway between the printed windows: 15.25 and 42.2 degrees.",
                              "For single volunteers, the geometric model is wrong by up to 11 degrees at 150 % and at the maximum: the "
                              "distance of a target gives the class, "
                              "not the angle."}};
  const auto windows = study::angle_windows();
  for (std::size_t k = 0; k < study::healthy().size(); ++k) {
    for (const study::AngleWindow& window : windows) {
      table.rows.push_back({.label = std::string(study::healthy()[k].name) + ", " + std::string(window.condition),
                            .printed = {{"deg", window.measured_deg[k]}},
                            .ours = {{"deg", window.geometry_deg[k]}},
                            .deviation = {{"deg", window.geometry_deg[k] - window.measured_deg[k]}}});
    }
  }
  for (const study::AngleWindow& window : windows) {
    const std::string condition(window.condition);
    add_window(condition, "printed", window.measured, table.summary);
    add_window(condition, "ours", window.geometry, table.summary);
    table.summary.push_back({"bias_" + condition + "_deg", window.bias_deg});
    table.summary.push_back({"rms_" + condition + "_deg", window.rms_deg});
  }
  return table;
}

}  // namespace dts::lab
