// SPDX-License-Identifier: Apache-2.0
#include "lab/cop/cop_points.h"

#include <limits>
#include <utility>

namespace dts::lab::cop {
namespace {

// Wider than any rig; the limits reject typing errors.
constexpr double kLargestLoadN = 1e5;
constexpr double kLargestDeflectionMm = 1000.0;
constexpr double kAnywhereMm = 1e4;
constexpr double kLargestWidthMm = 2000.0;

/// Returns the value of a row; NaN if the column does not exist.
double value_at(const std::vector<double>& column, std::size_t row) {
  return column.empty() ? std::numeric_limits<double>::quiet_NaN() : column[row];
}

}  // namespace

CopPoints read_cop_points(const std::string& file, std::size_t sensor_count, bool needs_truth, const std::optional<physics::Plate>& plate,
                          files::Problems& problems) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < sensor_count; ++k) names.push_back("w" + std::to_string(k + 1) + "_mm");
  const double a_mm = plate ? plate->a.value : kAnywhereMm;
  const double b_mm = plate ? plate->b.value : kAnywhereMm;
  const double off_plate_mm = plate ? 0.0 : -kAnywhereMm;
  std::vector<CsvColumn> columns{
      {.name = "p_n",
       .is_required = needs_truth,
       .may_be_empty = !needs_truth,
       .minimum = needs_truth ? 1e-3 : 0.0,
       .maximum = kLargestLoadN},
      {.name = "x_mm", .is_required = needs_truth, .may_be_empty = !needs_truth, .minimum = off_plate_mm, .maximum = a_mm},
      {.name = "y_mm", .is_required = needs_truth, .may_be_empty = !needs_truth, .minimum = off_plate_mm, .maximum = b_mm}};
  for (const std::string& name : names)
    columns.push_back({.name = name, .minimum = -kLargestDeflectionMm, .maximum = kLargestDeflectionMm});
  if (!needs_truth) {
    columns.push_back({.name = kPersonColumn, .is_required = false, .is_text = true});
    columns.push_back({.name = kWidthColumn, .is_required = false, .may_be_empty = true, .minimum = 0.0, .maximum = kLargestWidthMm});
    columns.push_back({.name = kWeightColumn, .is_required = false, .may_be_empty = true, .minimum = 0.0, .maximum = kLargestLoadN});
    for (const char* name : kEstimateColumns) columns.push_back({.name = name, .is_required = false, .is_text = true});
  }
  const std::size_t before = problems.size();
  CopPoints points{.table = CsvTable::read(file, columns, problems), .samples = {}};
  for (const char* name : kEstimateColumns) {
    if (points.table.has(name)) problems.push_back({file, 1, 1, "has estimates already (column '" + std::string(name) + "')"});
  }
  if (problems.size() != before) return points;
  for (std::size_t row = 0; row < points.table.row_count(); ++row) {
    physics::CopSample sample{
        .load_position = {{value_at(points.table.numbers("x_mm"), row)}, {value_at(points.table.numbers("y_mm"), row)}},
        .load = {value_at(points.table.numbers("p_n"), row)},
        .deflection_mm = {}};
    for (const std::string& name : names) sample.deflection_mm.push_back(points.table.numbers(name)[row]);
    points.samples.push_back(std::move(sample));
  }
  return points;
}

}  // namespace dts::lab::cop
