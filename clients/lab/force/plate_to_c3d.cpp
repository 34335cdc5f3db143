// SPDX-License-Identifier: Apache-2.0
#include "lab/force/plate_to_c3d.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "c3d/c3d_writer.h"
#include "files/whole_file.h"
#include "lab/force/plate_view.h"
#include "physics/conversions.h"

namespace dts::lab::force {
namespace {

constexpr std::size_t kSamplesAtOnce = std::size_t{1} << 20U;

/// A square around the origin. Its z points down in a laboratory with z up, unless the file says that it points up; OpenSim has y up.
c3d::Corners square(const ForceFile& file) {
  constexpr double kHalf = 200.0;
  if (file.is_z_down == false) return {{{kHalf, kHalf, 0}, {-kHalf, kHalf, 0}, {-kHalf, -kHalf, 0}, {kHalf, -kHalf, 0}}};
  if (file.axes == Axes::Laboratory) return {{{kHalf, 0, -kHalf}, {-kHalf, 0, -kHalf}, {-kHalf, 0, kHalf}, {kHalf, 0, kHalf}}};
  return {{{kHalf, -kHalf, 0}, {-kHalf, -kHalf, 0}, {-kHalf, kHalf, 0}, {kHalf, kHalf, 0}}};
}

/// Returns a sample in the axes of its plate. OpenSim has axes of the laboratory: plate x = x, y = -z, z = y.
ForceSample in_plate_axes(const ForceFile& file, ForceSample sample) {
  if (file.axes == Axes::Plate) return sample;
  const auto turned = [](const Vector& vector) { return Vector{vector[0], -vector[2], vector[1]}; };
  sample.force_n = turned(sample.force_n);
  sample.cop_mm = turned(sample.cop_mm);
  return sample;
}

}  // namespace

core::Status write_c3d(const ForceFile& file, double least_force_n, const std::string& out, std::vector<std::string>& warnings) {
  c3d::Outline outline{.rate_hz = file.rate_hz, .samples = file.samples, .software = "dtslab " DTS_VERSION};
  std::vector<PlateView> views;
  for (std::size_t plate = 0; plate < file.plates.size(); ++plate) {
    const bool has_place = file.axes == Axes::Plate && place_of(file.plates[plate]).has_value();
    if (!has_place)
      warnings.push_back("plate " + std::to_string(plate + 1) + ": no corners; a square of 400 mm around the origin is written");
    outline.plates.push_back(has_place ? *file.plates[plate].corners_mm : square(file));
    views.emplace_back(file, plate, file.axes, least_force_n);
  }
  outline.events = file.events;
  if (outline.events.size() > c3d::kMostEvents) {
    warnings.push_back("only the first " + std::to_string(c3d::kMostEvents) + " of " + std::to_string(outline.events.size()) +
                       " events are written");
    outline.events.resize(c3d::kMostEvents);
  }
  if (!file.t_s.empty()) {
    const double end_s = file.t_s.front() + static_cast<double>(file.samples - 1) / file.rate_hz;
    if (std::abs(file.t_s.back() - end_s) > 0.5 / file.rate_hz) warnings.emplace_back("the times are not even: C3D has only a rate");
  }
  DTS_TRY_ASSIGN(std::string bytes, file_beginning(outline));
  DTS_TRY_ASSIGN(auto writer, files::WholeFileWriter::create(out));
  bool has_height = false;
  bool has_lost_moments = false;
  for (std::size_t sample = 0; sample < file.samples; ++sample) {
    for (const PlateView& view : views) {
      const ForceSample seen = in_plate_axes(file, view.at(sample));
      has_lost_moments = has_lost_moments || (std::isfinite(seen.moment_nm[0]) && !std::isfinite(seen.cop_mm[0]));
      has_height = has_height || std::abs(seen.cop_mm[2]) > 1e-6;
      const std::array<double, c3d::kChannelsOfPlate> values{seen.force_n[0], seen.force_n[1],
                                                             seen.force_n[2], seen.cop_mm[0],
                                                             seen.cop_mm[1],  seen.free_moment_nm * physics::kMillimetresPerMetre};
      c3d::append_sample(bytes, values);
    }
    if (bytes.size() < kSamplesAtOnce) continue;
    DTS_TRY(writer.append(bytes));
    bytes.clear();
  }
  if (has_height) warnings.emplace_back("the COP has a height, which a plate of type 1 cannot have: it is written without");
  if (has_lost_moments) {
    warnings.emplace_back("samples below --min-force have no COP: a plate of type 1 cannot have their moments Mx, My and Mz");
  }
  DTS_TRY(writer.append(bytes));
  return writer.commit();
}

}  // namespace dts::lab::force
