// SPDX-License-Identifier: Apache-2.0
#include "lab/plate/plate_case.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "files/rig_model_file.h"
#include "physics/plate/grid.h"

namespace dts::lab::plate {
namespace {

using files::Problems;
using files::TomlReader;
using physics::Plate;

// Limits of physics::check; they reject typing errors and files that would need all memory.
constexpr double kLargestForceN = 1e6;
constexpr std::size_t kMostLoads = 1000;
constexpr std::size_t kMostProbes = 10'000;

constexpr std::array<std::string_view, 4> kRectangleKeys{"x0_mm", "x1_mm", "y0_mm", "y1_mm"};

/// Reads a required position, which must be on the plate.
physics::Point read_point(TomlReader& reader, const Plate& plate) {
  reader.require("x_mm");
  reader.require("y_mm");
  return {.x = {reader.number("x_mm", 0.0, 0.0, plate.a.value)}, .y = {reader.number("y_mm", 0.0, 0.0, plate.b.value)}};
}

/// Centre and length of a stretch of an axis; rounding must not move its ends off the plate.
struct Stretch {
  core::Millimetres centre;
  core::Millimetres length;

  Stretch(double from_mm, double to_mm, double side_mm)
      : centre{(from_mm + to_mm) / 2.0}, length{std::min({to_mm - from_mm, 2.0 * centre.value, 2.0 * (side_mm - centre.value)})} {}
};

physics::Patch read_rectangle(TomlReader& reader, const Plate& plate) {
  for (const std::string_view key : kRectangleKeys) reader.require(key);
  const double x0_mm = reader.number("x0_mm", 0.0, 0.0, plate.a.value);
  const double x1_mm = reader.number("x1_mm", plate.a.value, 0.0, plate.a.value);
  const double y0_mm = reader.number("y0_mm", 0.0, 0.0, plate.b.value);
  const double y1_mm = reader.number("y1_mm", plate.b.value, 0.0, plate.b.value);
  if (x1_mm < x0_mm) reader.report("x1_mm", "x1_mm of [[load]] is left of x0_mm");
  if (y1_mm < y0_mm) reader.report("y1_mm", "y1_mm of [[load]] is below y0_mm");
  const Stretch x(x0_mm, x1_mm, plate.a.value);
  const Stretch y(y0_mm, y1_mm, plate.b.value);
  return {.centre = {x.centre, y.centre}, .width = x.length, .height = y.length};
}

physics::PlateLoad read_load(TomlReader& reader, const Plate& plate) {
  physics::PlateLoad load;
  const bool is_rectangle = std::ranges::any_of(kRectangleKeys, [&](std::string_view key) { return reader.has(key); });
  if (is_rectangle && (reader.has("x_mm") || reader.has("y_mm"))) {
    reader.report("", "[[load]] is either a point (x_mm, y_mm) or a rectangle (x0_mm, x1_mm, y0_mm, y1_mm), not both");
  }
  load.area = is_rectangle ? read_rectangle(reader, plate) : physics::Patch{.centre = read_point(reader, plate)};
  reader.require("force_n");
  load.force = {reader.number("force_n", 1.0, -kLargestForceN, kLargestForceN)};
  if (load.force.value == 0.0) reader.report("force_n", "force_n of [[load]] is 0; it must press (positive) or pull");
  reader.finish();
  return load;
}

void read_loads(TomlReader& top, physics::PlateCase& plate_case) {
  auto readers = top.tables("load");
  if (readers.empty() && !top.has("load")) top.report("", "no [[load]]: name at least one");
  if (readers.size() > kMostLoads) {
    top.report("load", std::to_string(readers.size()) + " [[load]] tables; allowed: 1 .. " + std::to_string(kMostLoads));
    return;
  }
  for (TomlReader& reader : readers) plate_case.loads.push_back(read_load(reader, plate_case.plate));
}

void read_probes(TomlReader& top, physics::PlateCase& plate_case) {
  auto readers = top.tables("probe");
  if (readers.size() > kMostProbes) {
    top.report("probe", std::to_string(readers.size()) + " [[probe]] tables; allowed: 0 .. " + std::to_string(kMostProbes));
    return;
  }
  for (TomlReader& reader : readers) {
    plate_case.probes.push_back(read_point(reader, plate_case.plate));
    reader.finish();
  }
}

void read_solver(TomlReader reader, PlateCaseFile& read) {
  read.is_nonlinear = reader.boolean("nonlinear", false);
  read.method = reader.choice("method", {"fdm", "fem"}) == "fem" ? physics::PlateMethod::Fem : physics::PlateMethod::Fdm;
  const int most = read.is_nonlinear ? physics::kMostNonlinearDivisions : physics::Grid::kMaxDivisions;
  const auto divisions = reader.integer("divisions", 0, physics::Grid::kMinDivisions, most);
  if (divisions > 0) read.divisions = static_cast<int>(divisions);
  read.spreads_point_loads = reader.boolean("simpson", false);
  if (read.spreads_point_loads && read.method == physics::PlateMethod::Fem) {
    reader.report("simpson", "simpson = true of [solver] belongs to method \"fdm\" (thesis eq. 3.13)");
  }
  reader.finish();
}

}  // namespace

PlateCaseFile read_plate_case(const std::string& file, Problems& problems) {
  PlateCaseFile read;
  const auto table = files::parse_toml(file, problems);
  if (!table) return read;
  TomlReader top(&*table, "", file, problems);
  for (const char* name : {"plate", "support"}) {
    if (!top.has(name)) top.report("", "[" + std::string(name) + "] is missing");
  }
  physics::PlateCase& plate_case = read.plate_case;
  if (top.has("plate")) plate_case.plate = files::read_plate(top.table("plate"));
  plate_case.support = files::read_support(top.table("support"), plate_case.plate);
  read_loads(top, plate_case);
  read_probes(top, plate_case);
  read_solver(top.table("solver"), read);
  top.finish();
  return read;
}

}  // namespace dts::lab::plate
