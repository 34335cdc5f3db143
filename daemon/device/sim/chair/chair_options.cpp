// SPDX-License-Identifier: Apache-2.0
#include "device/sim/chair/chair_options.h"

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "core/block.h"
#include "device/sim/shared_options.h"

namespace dts::device::sim {
namespace {

using core::ErrorCode;
using enum OptionKind;

constexpr std::array kChairTable = {
    UriOption{"seed", Integer, "1", 0, 4294967295.0, "", "Chooses habits, noise, gains and gaps; the same seed gives the same data."},
    UriOption{"weight_kg", Number, "70", 10, 250, "", "Of the person."},
    UriOption{"height_cm", Number, "175", 80, 230, "", "Of the person."},
    UriOption{"arm_length_cm", Number, "68", 25, 110, "", "From the acromion to the third metacarpal head."},
    UriOption{"max_reach_cm", Number, "125", 20, 220, "",
              "From the acromion to the farthest target reached without lifting from the seat."},
    UriOption{"group", Word, "healthy", 0, 0, "healthy|stroke", "After a stroke: slower, jerky, the trunk helps within the arm's reach."},
    UriOption{"people_spread", Number, "1", 0, 1, "", "How much the habits of two seeds differ; 0: all people are the same."},
    UriOption{"reaches", Word, "auto", 0, 0, "auto|cued|none",
              "When the person reaches: by itself until the first cue, on cues only, or never."},
    UriOption{"pace_s", Number, "0", 0, 10, "", "Duration of one phase, there or back; 0: the person's own pace."},
    UriOption{"double_reach", Integer, "0", 0, 1, "", "1: every reach goes most of the way back and out again."},
    UriOption{"sit_down_s", Number, "2.5", 0, 86400, "",
              "When the person first touches the chair; it is empty before, so that it can be tared."},
    UriOption{"stand_up_s", Number, "never", 0, kNever, "", "When the person begins to stand up, also in the middle of a reach."},
    UriOption{"fidgets", Integer, "1", 0, 1, "", "1: now and then the person fidgets or shifts."},
    UriOption{"back_rest", Integer, "1", 0, 1, "", "0: the person sits upright and leans on nothing."},
    UriOption{"load_model", Word, "cop", 0, 0, "cop|thesis", "How the body loads the seat (reach-model section 4)."},
    UriOption{"noise_mv", Number, "3", 0, 1000, "", "White noise of every converted channel, rms."},
    UriOption{"bits", Integer, "16", 11, 16, "", "Resolution of the converter."},
    shared_option::kRange,
    shared_option::kClock,
    shared_option::kGainSpread,
    UriOption{"gap_spread_mm", Number, "0.1", 0, 1, "", "Unloaded gaps differ from the nominal one by up to this."},
    UriOption{"drift", Number, "0", 0, 20, "", "Sensor gains drift by up to this, percent in an hour."},
    shared_option::kSensors,
    UriOption{"aux", Word, "none", 0, 0, "none|emg", "Six channels as of surface electrodes on arm and back."},
    UriOption{"truth", Integer, "1", 0, 1, "", "1: auxiliary channels true_trunk_deg, true_y_mm and true_load_n."},
    UriOption{"dead", Numbers, "", 0, 31, "", "Sensors, counted from 0, that give 0 V."},
    UriOption{"saturated", Numbers, "", 0, 31, "", "Sensors, counted from 0, at the end of the converter's range."},
    UriOption{"sensor_fault_at_s", Number, "0", 0, 1e6, "", "Device time since start from which they are dead or saturated."},
    UriOption{"swapped", Text, "", 0, 0, "", "Two sensors, counted from 0, whose cables are exchanged: I:J."},
    shared_option::kFault,
    shared_option::kFaultAt,
    shared_option::kFaultFor,
    shared_option::kFaultChannel,
};

constexpr std::array kChairDependencies = {
    Dependency{"pace_s", "reaches", "auto|cued"},
    Dependency{"double_reach", "reaches", "auto|cued"},
    Dependency{"back_rest", "load_model", "cop"},
    shared_option::kFaultChannelNeeds,
};

dts::sim::ReachMode reach_mode(const std::string& word) {
  if (word == "cued") return dts::sim::ReachMode::Cued;
  return word == "none" ? dts::sim::ReachMode::Never : dts::sim::ReachMode::Auto;
}

dts::sim::SeatedPersonOptions person(const UriOptions& options, std::uint64_t seed) {
  dts::sim::SeatedPersonOptions result;
  result.person = {.weight_kg = options.number("weight_kg"),
                   .height_cm = options.number("height_cm"),
                   .arm_length_cm = options.number("arm_length_cm"),
                   .max_reach_cm = options.number("max_reach_cm")};
  const bool is_thesis = options.text("load_model") == "thesis";
  const auto model = is_thesis ? dts::sim::SeatLoadModel::Thesis : dts::sim::SeatLoadModel::Cop;
  result.habits = dts::sim::natural_habits(result.person, options.text("group") == "healthy", model, seed, options.number("people_spread"));
  if (options.number("pace_s") > 0.0) {
    result.habits.phase_s = options.number("pace_s");
    result.habits.phase_growth_per_deg = 0.0;
  }
  if (options.number("back_rest") == 0.0) result.habits.load.lean_back_deg = 0.0;
  result.mode = reach_mode(options.text("reaches"));
  result.has_fidgets = options.number("fidgets") == 1.0;
  result.has_double_reaches = options.number("double_reach") == 1.0;
  result.sit_down_s = options.number("sit_down_s");
  result.stand_up_s = options.number("stand_up_s");
  result.seed = seed;
  return result;
}

/// Returns the channel numbers of a list; they must be integers below `sensors`.
core::Result<std::vector<std::size_t>> channel_list(const DeviceUri& uri, const UriOptions& options, const std::string& name,
                                                    std::size_t sensors) {
  std::vector<std::size_t> channels;
  if (!options.is_given(name)) return channels;
  for (const double number : options.numbers(name)) {
    if (number != std::floor(number) || number >= static_cast<double>(sensors)) {
      return refuse(uri, ErrorCode::InvalidArgument, name + " must have whole numbers 0 .. " + std::to_string(sensors - 1));
    }
    channels.push_back(static_cast<std::size_t>(number));
  }
  return channels;
}

core::Result<std::pair<std::size_t, std::size_t>> channel_pair(const DeviceUri& uri, const std::string& text, std::size_t sensors) {
  std::pair<std::size_t, std::size_t> pair;
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, pair.first);
  const bool has_colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
  const auto second = has_colon ? std::from_chars(first.ptr + 1, end, pair.second) : first;
  const bool is_pair = has_colon && second.ec == std::errc() && second.ptr == end;
  if (is_pair && pair.first < sensors && pair.second < sensors && pair.first != pair.second) return pair;
  return refuse(uri, ErrorCode::InvalidArgument,
                "swapped = " + text + " is not allowed; write two different sensors as I:J, each 0 .. " + std::to_string(sensors - 1));
}

core::Result<SensorFaults> sensor_faults(const DeviceUri& uri, const UriOptions& options, std::size_t sensors) {
  SensorFaults faults{.from_s = options.number("sensor_fault_at_s")};
  for (const auto& [name, list] : {std::pair{"dead", &faults.dead}, std::pair{"saturated", &faults.saturated}}) {
    DTS_TRY_ASSIGN(*list, channel_list(uri, options, name, sensors));
  }
  if (options.is_given("sensor_fault_at_s") && faults.dead.empty() && faults.saturated.empty()) {
    return refuse(uri, ErrorCode::InvalidArgument, "sensor_fault_at_s has an effect only with dead=... or saturated=...");
  }
  if (!options.is_given("swapped")) return faults;
  DTS_TRY_ASSIGN(faults.swapped, channel_pair(uri, options.text("swapped"), sensors));
  return faults;
}

core::Status check_channels(const DeviceUri& uri, const ChairOptions& options, std::size_t rig_sensors) {
  if (options.sensors < 1 || options.sensors > rig_sensors) {
    return refuse(uri, ErrorCode::InvalidArgument,
                  "sensors = " + std::to_string(options.sensors) + ", but the rig has " + std::to_string(rig_sensors));
  }
  const std::size_t channels = options.converted_channels() + (options.has_truth ? kTruthChannels : 0);
  if (channels <= core::kMaxChannels) return {};
  return refuse(uri, ErrorCode::LimitExceeded,
                std::to_string(channels) + " channels with sensors, aux and truth; at most " + std::to_string(core::kMaxChannels));
}

core::Status check_stay(const DeviceUri& uri, const dts::sim::SeatedPersonOptions& person) {
  if (person.stand_up_s >= person.sit_down_s + dts::sim::SeatedPerson::kSettlingS) return {};
  return refuse(uri, ErrorCode::InvalidArgument, "stand_up_s is less than 2 s after sit_down_s");
}

}  // namespace

std::span<const UriOption> chair_option_table() { return kChairTable; }

core::Result<ChairOptions> read_chair_options(const DeviceUri& uri, std::size_t rig_sensors) {
  DTS_TRY_ASSIGN(const auto options, UriOptions::read(uri, kChairTable));
  DTS_TRY(check_dependencies(uri, options, kChairDependencies));

  ChairOptions result;
  result.seed = static_cast<std::uint64_t>(options.number("seed"));
  result.person = person(options, result.seed);
  DTS_TRY(check_stay(uri, result.person));
  result.daq = {options.number("range_v"), static_cast<int>(options.number("bits")), options.number("noise_mv") * kMillivolt, result.seed};
  result.clock_error_ppm = options.number("clock_ppm");
  result.gain_spread = options.number("gain_spread");
  result.gap_spread_mm = options.number("gap_spread_mm");
  result.drift_percent_per_h = options.number("drift");
  result.sensors = static_cast<std::size_t>(options.number("sensors"));
  if (result.sensors == 0) result.sensors = rig_sensors;
  result.has_emg = options.text("aux") == "emg";
  result.has_truth = options.number("truth") == 1.0;
  DTS_TRY(check_channels(uri, result, rig_sensors));
  DTS_TRY_ASSIGN(result.sensor_faults, sensor_faults(uri, options, result.sensors));
  DTS_TRY_ASSIGN(result.fault, read_fault(uri, options, result.converted_channels()));
  return result;
}

}  // namespace dts::device::sim
