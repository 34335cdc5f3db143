// SPDX-License-Identifier: Apache-2.0
#include "session/calibration_check.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "core/utc_text.h"

namespace dts::session {
namespace {

constexpr std::size_t kDateLength = 10;  // of "2026-01-31T12:00:00Z"
constexpr std::chrono::days kCalibrationLife{180};

/// A "; " divides a notice into what is wrong and what to do.
std::string without_semicolons(std::string text) {
  std::ranges::replace(text, ';', ',');
  return text;
}

std::string unit_text(const std::string& model, const std::string& serial) {
  return without_semicolons(model + (serial.empty() ? "" : " " + serial));
}

/// The rig and the unit that is open now.
class Present {
 public:
  Present(const pipeline::RigConfig& config, const device::DeviceDescription& described, const device::DeviceReport& report)
      : config_(config), described_(described), report_(report), unit_(device::unit_name(described, report)) {}

  [[nodiscard]] const pipeline::RigConfig& config() const noexcept { return config_; }
  [[nodiscard]] std::string rig_text() const { return "rig '" + config_.name + "': "; }
  [[nodiscard]] std::string text() const { return unit_text(unit_.model, unit_.serial); }
  [[nodiscard]] std::string serial() const { return without_semicolons(unit_.serial); }
  [[nodiscard]] bool is_simulated() const { return config_.device_uri.starts_with("sim:"); }
  [[nodiscard]] bool is_replay() const { return config_.device_uri.starts_with("replay:"); }
  [[nodiscard]] bool has_other_model(const std::string& model) const { return model != unit_.model && !is_of_kind(model); }
  [[nodiscard]] bool has_other_name(const std::string& rig) const { return !rig.empty() && rig != config_.name; }
  [[nodiscard]] bool is_other_unit(const std::string& model, const std::string& serial) const {
    return !is_simulated() && !is_of_kind(model) && !serial.empty() && !unit_.serial.empty() && serial != unit_.serial;
  }
  /// Returns the name of the channel that sensor `index` is read from; empty: unknown.
  [[nodiscard]] std::string channel_of(std::size_t index) const {
    const std::size_t channel = config_.sensor_channels[index];
    return channel < described_.channels.size() ? described_.channels[channel].name : "";
  }

 private:
  /// Made before dtsd could read the model of such a device: it has the name of the kind, and no serial number of the unit.
  [[nodiscard]] bool is_of_kind(const std::string& model) const { return !report_.model.empty() && model == described_.model; }

  const pipeline::RigConfig& config_;
  const device::DeviceDescription& described_;
  const device::DeviceReport& report_;
  device::UnitName unit_;
};

std::string cop_warning(const Present& present, std::int64_t now_utc_ns) {
  if (!present.config().cop_calibration) return {};
  const physics::CopCalibrationOrigin& origin = present.config().cop_calibration->origin;
  const std::string which =
      present.rig_text() + "the calibration of " + without_semicolons(origin.created_utc.substr(0, kDateLength)) + " ";
  const std::string again = "; calibrate again: dtsctl calibrate cop --rig " + present.config().name;
  const std::string compare =
      "; compare a known weight on the middle and near each corner, or calibrate again: dtsctl calibrate cop --rig " +
      present.config().name;
  if (origin.daq_model.empty()) {  // made with dtslab: it knows no DAQ, and its rig is the name of a file
    return present.is_simulated() ? std::string() : which + "names no DAQ: it was computed from a model or from a table of loads" + again;
  }
  const std::string unit = unit_text(origin.daq_model, origin.daq_serial);
  if (present.has_other_model(origin.daq_model)) return which + "was measured with " + unit + ", not with " + present.text() + again;
  if (present.has_other_name(origin.rig)) return which + "is of rig '" + without_semicolons(origin.rig) + "'" + again;
  if (present.is_other_unit(origin.daq_model, origin.daq_serial)) {
    return which + "was measured with " + unit + ", and the device is " + present.serial() + ", another unit of the same model" + compare;
  }
  const std::string oldest = core::utc_text(now_utc_ns - std::chrono::nanoseconds(kCalibrationLife).count());
  const bool is_old = origin.created_utc < oldest && !present.is_simulated();
  return is_old ? which + "is more than " + std::to_string(kCalibrationLife.count()) + " days old" + compare : "";
}

/// In the order in which a sensor is judged.
enum class CurveDoubt : std::uint8_t { OtherRig, OtherSensor, OtherModel, OtherChannel, OtherUnit };

/// A label without a rig is one that somebody chose for a table of readings.
std::optional<CurveDoubt> doubt_of(const Present& present, std::size_t index) {
  const physics::SensorModel& sensor = present.config().model.sensors[index];
  const physics::SensorCurveOrigin& origin = sensor.curve_origin;
  if (present.has_other_name(origin.rig)) return CurveDoubt::OtherRig;  // whose labels mean other sensors
  if (!origin.rig.empty() && !origin.sensor.empty() && origin.sensor != sensor.label) return CurveDoubt::OtherSensor;
  if (!origin.daq_model.empty() && present.has_other_model(origin.daq_model)) return CurveDoubt::OtherModel;
  const std::string channel = present.channel_of(index);
  if (!origin.channel.empty() && !channel.empty() && origin.channel != channel) return CurveDoubt::OtherChannel;
  if (present.is_other_unit(origin.daq_model, origin.daq_serial)) return CurveDoubt::OtherUnit;
  return std::nullopt;
}

/// Returns what the sensors of one warning have in common: two DAQs or two rigs are two warnings.
std::string common_of(CurveDoubt doubt, const physics::SensorCurveOrigin& origin) {
  switch (doubt) {
    case CurveDoubt::OtherModel:
    case CurveDoubt::OtherUnit: return unit_text(origin.daq_model, origin.daq_serial);
    case CurveDoubt::OtherRig: return without_semicolons(origin.rig);
    case CurveDoubt::OtherSensor:
    case CurveDoubt::OtherChannel: break;
  }
  return {};
}

std::string curve_warning(const Present& present, CurveDoubt doubt, const std::string& common, const std::vector<std::size_t>& indices) {
  const auto& sensors = present.config().model.sensors;
  const auto listed = [&](auto name_of) {
    std::string list;
    for (const std::size_t index : indices) list += (list.empty() ? "" : ", ") + without_semicolons(name_of(index));
    return list;
  };
  const std::string which = present.rig_text() + "sensor curves (" + listed([&](std::size_t i) { return sensors[i].label; }) + ") ";
  const std::string again = "calibrate again: dtsctl calibrate sensor --rig " + present.config().name + " --sensor all";
  switch (doubt) {
    case CurveDoubt::OtherSensor:
      return which + "were measured at other sensors (" + listed([&](std::size_t i) { return sensors[i].curve_origin.sensor; }) +
             "); name the file of each sensor in the rig file, or " + again;
    case CurveDoubt::OtherModel: return which + "were measured with " + common + ", not with " + present.text() + "; " + again;
    case CurveDoubt::OtherRig: return which + "are of rig '" + common + "'; " + again;
    case CurveDoubt::OtherChannel:
      return which + "were measured on channels (" + listed([&](std::size_t i) { return sensors[i].curve_origin.channel; }) +
             "), not on (" + listed([&](std::size_t i) { return present.channel_of(i); }) +
             "); check the wiring and channel in the rig file, or " + again;
    case CurveDoubt::OtherUnit:
      return which + "were measured with " + common + ", and the device is " + present.serial() +
             ", another unit of the same model; compare a known distance, or " + again;
  }
  return {};
}

/// The simulator makes its volts from the curves of the rig: there they are always right.
std::vector<std::string> curve_warnings(const Present& present) {
  if (present.is_simulated()) return {};
  std::map<std::pair<CurveDoubt, std::string>, std::vector<std::size_t>> doubtful;
  const auto& sensors = present.config().model.sensors;
  for (std::size_t index = 0; index < sensors.size(); ++index) {
    if (const auto doubt = doubt_of(present, index)) doubtful[{*doubt, common_of(*doubt, sensors[index].curve_origin)}].push_back(index);
  }
  std::vector<std::string> warnings;
  for (const auto& [reason, indices] : doubtful) warnings.push_back(curve_warning(present, reason.first, reason.second, indices));
  return warnings;
}

}  // namespace

std::vector<std::string> calibration_warnings(const pipeline::RigConfig& config, const device::DeviceDescription& described,
                                              const device::DeviceReport& report, std::int64_t now_utc_ns) {
  const Present present(config, described, report);
  // A replayed recording has the volts of its own DAQ, and the calibration may be newer on purpose.
  if (present.is_replay()) return {};
  std::vector<std::string> warnings = curve_warnings(present);
  if (std::string warning = cop_warning(present, now_utc_ns); !warning.empty()) warnings.insert(warnings.begin(), std::move(warning));
  return warnings;
}

}  // namespace dts::session
