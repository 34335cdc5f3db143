// SPDX-License-Identifier: Apache-2.0
#include "lab/simulate/simulated_rig.h"

#include <ostream>
#include <sstream>
#include <utility>

#include "files/toml_text.h"
#include "lab/base/thesis_setup.h"
#include "sim/chair_rig.h"

namespace dts::lab::simulate {
namespace {

constexpr double kCurveStepMm = 0.25;  // between the points of the assumed curve

std::string curve_text(const physics::SensorCurve& curve) {
  std::ostringstream out;
  out << "{ name = " << files::toml_quoted(curve.name()) << ", point = [ ";
  const double first_mm = curve.minimum_gap().value;
  const auto steps = static_cast<int>((curve.maximum_gap().value - first_mm) / kCurveStepMm + 0.5);
  for (int step = 0; step <= steps; ++step) {
    const core::Millimetres gap{first_mm + step * kCurveStepMm};
    out << (step == 0 ? "" : ", ") << "{ gap_mm = " << files::toml_number(gap.value)
        << ", volts = " << files::toml_number(curve.volts(gap).value) << " }";
  }
  out << " ] }";
  return std::move(out).str();
}

/// Writes plate, support, rate and sensors.
void write_model(std::ostream& out, const physics::RigModel& rig, double rate_hz) {
  out << "\n[plate]\na_mm = " << files::toml_number(rig.plate.a.value) << "\nb_mm = " << files::toml_number(rig.plate.b.value)
      << "\nh_mm = " << files::toml_number(rig.plate.h.value) << "\ne_pa = " << files::toml_number(rig.plate.e_pa)
      << "\nnu = " << files::toml_number(rig.plate.nu) << "\n\n[support]\n";
  if (rig.support.kind == physics::SupportKind::Corner) {
    out << "kind = \"corner\"\ninset_mm = " << files::toml_number(rig.support.inset.value) << '\n';
  } else {
    out << "kind = \"edges\"\n";
  }
  out << "\n[acquire]\nrate_hz = " << files::toml_number(rate_hz) << '\n';
  for (const physics::SensorModel& sensor : rig.sensors) {
    out << "\n[[sensor]]\nlabel = " << files::toml_quoted(sensor.label) << "\nx_mm = " << files::toml_number(sensor.position.x.value)
        << "\ny_mm = " << files::toml_number(sensor.position.y.value)
        << "\nunloaded_gap_mm = " << files::toml_number(sensor.unloaded_gap.value) << "\ncurve = " << curve_text(sensor.curve) << '\n';
  }
}

}  // namespace

std::string floor_definition(double rate_hz) {
  const physics::RigModel rig = thesis_setup::floor_platform();
  std::ostringstream out;
  out << "kind = \"floor\"\n";
  write_model(out, rig, rate_hz);
  out << "\n[[stage]]\nid = \"guard\"\n\n[[stage]]\nid = \"window_filter\"\nwindow_scans = 3\n\n"
         "[[stage]]\nid = \"linearise\"\n\n[[stage]]\nid = \"cop\"\nestimator = \"poly3\"\n";
  return std::move(out).str();
}

std::string force_plate_definition(double rate_hz, double top_mm) {
  std::ostringstream out;
  out << "kind = \"floor\"\n\n[force_plate]\nkind = \"kistler8\"\n"
         "scale_mv_per_n = [38.117, 37.723, 38.062, 38.008, 3.898, 3.889, 3.885, 3.891]\n"
         "a_mm = 120.0\nb_mm = 200.0\naz0_mm = -48.0\naxes = \"z_down\"\nsize_mm = [400.0, 600.0]\nml = \"+x\"\nap = \"-y\"\n"
         "\n[acquire]\nrate_hz = "
      << files::toml_number(rate_hz)
      << "\n\n[[stage]]\nid = \"guard\"\n\n[[stage]]\nid = \"force_plate\"\n\n[[stage]]\nid = \"force_cop\"\ntop_mm = "
      << files::toml_number(top_mm) << '\n';
  return std::move(out).str();
}

std::string chair_definition(double rate_hz) {
  const physics::RigModel rig = sim::chair_rig();
  const auto& used = *rig.transient_sensors;
  std::ostringstream out;
  out << "kind = \"chair\"\ntransient_sensors = [";
  const char* separator = "";
  for (const std::size_t index : {used.rear[0], used.rear[1], used.front[0], used.front[1]}) {
    out << std::exchange(separator, ", ") << files::toml_quoted(rig.sensors[index].label);
  }
  out << "]\n";
  write_model(out, rig, rate_hz);
  for (const char* stage : {"guard", "linearise", "transient", "reach"}) out << "\n[[stage]]\nid = \"" << stage << "\"\n";
  return std::move(out).str();
}

}  // namespace dts::lab::simulate
