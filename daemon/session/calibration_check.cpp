// SPDX-License-Identifier: Apache-2.0
#include "session/calibration_check.h"

#include <algorithm>

namespace dts::session {
namespace {

constexpr std::size_t kDateLength = 10;  // of "2026-01-31T12:00:00Z"

/// A "; " divides a notice into what is wrong and what to do.
std::string without_semicolons(std::string text) {
  std::ranges::replace(text, ';', ',');
  return text;
}

std::string unit_text(const std::string& model, const std::string& serial) {
  return without_semicolons(model + (serial.empty() ? "" : " " + serial));
}

}  // namespace

std::string calibration_warning(const pipeline::RigConfig& config, const device::DeviceDescription& described,
                                const device::DeviceReport& report) {
  // A replayed recording has the volts of its own DAQ, and the calibration may be newer on purpose.
  if (!config.cop_calibration || config.device_uri.starts_with("replay:")) return {};
  const physics::CopCalibrationOrigin& origin = config.cop_calibration->origin;
  const bool is_simulated = config.device_uri.starts_with("sim:");
  const std::string which = "rig '" + config.name + "': the calibration of " + origin.created_utc.substr(0, kDateLength) + " ";
  const std::string again = "; calibrate again: dtsctl calibrate cop --rig " + config.name;
  if (origin.daq_model.empty()) {  // made with dtslab: it knows no DAQ, and its rig is the name of a file
    return is_simulated ? std::string() : which + "names no DAQ: it was computed from a model or from a table of loads" + again;
  }
  const device::UnitName unit = device::unit_name(described, report);
  // Made before dtsd could read the model of such a device: it has the name of the kind, and no serial number of the unit.
  const bool is_of_kind = !report.model.empty() && origin.daq_model == described.model;
  if (origin.daq_model != unit.model && !is_of_kind) {
    return which + "was measured with " + unit_text(origin.daq_model, origin.daq_serial) + ", not with " +
           unit_text(unit.model, unit.serial) + again;
  }
  if (!origin.rig.empty() && origin.rig != config.name) return which + "is of rig '" + origin.rig + "'" + again;
  if (is_simulated || is_of_kind || origin.daq_serial.empty() || unit.serial.empty() || origin.daq_serial == unit.serial) return {};
  return which + "was measured with " + unit_text(origin.daq_model, origin.daq_serial) + ", and the device is " +
         without_semicolons(unit.serial) +
         ", another unit of the same model; compare a known weight on the middle and near each corner, or calibrate again: dtsctl "
         "calibrate cop --rig " +
         config.name;
}

}  // namespace dts::session
