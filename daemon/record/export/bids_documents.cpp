// SPDX-License-Identifier: Apache-2.0
#include "record/export/bids_documents.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "record/export/row_text.h"

namespace dts::record {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kProgram = "dtsd";

std::string document(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

/// Description of a channel in BIDS terms.
struct ChannelMotion {
  std::string component = "n/a";
  std::string type = "MISC";
  std::string point = "n/a";
};

/// Positions are the centre of pressure on the plate and the deflections at its sensors. All other channels are not motion (MISC).
ChannelMotion motion_of(const StreamInfo& stream, const ChannelInfo& channel) {
  if (channel.unit != "mm") return {};
  if (channel.label == "ml_mm") return {.component = "x", .type = "POS", .point = "cop"};
  if (channel.label == "ap_mm") return {.component = "y", .type = "POS", .point = "cop"};
  if (short_name(stream.name) != "deflection") return {};
  return {.component = "z", .type = "POS", .point = channel.label.substr(0, channel.label.rfind('_'))};
}

std::string rate_text(const StreamInfo& stream) {
  std::array<char, kLongestNumber> text{};
  const core::Rate rate = stream.rate.value_or(core::Rate{});
  return {text.data(), put_value(text.data(), rate.hz(), ValueType::Double64, "")};
}

std::string channel_row(const std::string& name, const ChannelMotion& motion, const std::string& units, const std::string& rate,
                        const std::string& description) {
  const bool is_position = motion.type == "POS";
  std::string row = tsv_cell(name);
  for (const std::string& cell : {motion.component, motion.type, motion.point, units, rate, description}) row += "\t" + tsv_cell(cell);
  return row + "\tn/a\t" + (is_position ? "plate" : "n/a") + "\n";
}

std::string channel_description(const ChannelInfo& channel) {
  std::string text = channel.device_channel >= 0 ? "device channel " + std::to_string(channel.device_channel) : std::string();
  if (channel.is_sensor) text += (text.empty() ? "" : ", ") + std::string("displacement sensor");
  if (channel.is_marker) text += (text.empty() ? "" : ", ") + std::string("marker channel");
  return text;
}

}  // namespace

std::string dataset_description(const std::string& software) {
  const std::size_t space = software.rfind(' ');
  Json generator{{"Name", kProgram}, {"Description", "Recordings of distributive tactile sensing plates"}};
  if (space != std::string::npos) generator["Version"] = software.substr(space + 1);
  return document({{"Name", "Distributive tactile sensing recordings"},
                   {"BIDSVersion", "1.9.0"},
                   {"DatasetType", "raw"},
                   {"GeneratedBy", Json::array({std::move(generator)})}});
}

bool is_our_dataset(const std::string& description) {
  const Json json = Json::parse(description, nullptr, false);
  if (!json.is_object() || !json.contains("GeneratedBy") || !json["GeneratedBy"].is_array()) return false;
  return std::ranges::any_of(json["GeneratedBy"],
                             [](const Json& by) { return by.is_object() && by.contains("Name") && by["Name"] == kProgram; });
}

std::string dataset_readme() {
  return "Recordings of plates with distributive tactile sensing, exported by dtsd.\n\n"
         "Every tracking system is one stream of one rig: raw and filtered volts of the sensors, their deflections, and the centre of\n"
         "pressure (cop). Axes of the plate: x to the subject's right, y forward, origin at the plate's centre, deflections along the "
         "load.\n"
         "Each table of samples begins with a LATENCY channel: seconds since the recording's first scan. Where it jumps, scans are\n"
         "missing; nothing is interpolated. Undefined values (nobody on the plate) are n/a. The events tell of gaps, markers, trials.\n"
         "sourcedata/*/*_recording.json says of each recording what is missing, on which device, and what was asked about the subject.\n"
         "Subjects are pseudonyms given by the clinic. sub-unknown holds the sessions that were recorded without one: they may be of\n"
         "several people.\n";
}

std::string participants_description() {
  return document({{"participant_id", {{"Description", "The pseudonym, with letters and digits only"}}},
                   {"pseudonym", {{"Description", "The pseudonym as the clinic gave it"}}}});
}

std::string channels_table(const StreamInfo& stream) {
  const std::string rate = rate_text(stream);
  std::string table = "name\tcomponent\ttype\ttracked_point\tunits\tsampling_frequency\tdescription\tstatus\treference_frame\n";
  table += channel_row("latency", {.type = "LATENCY"}, "s", rate, "since the first scan of the recording");
  for (const ChannelInfo& channel : stream.channels) {
    table += channel_row(channel.label, motion_of(stream, channel), channel.unit, rate, channel_description(channel));
  }
  return table;
}

std::string channels_description() {
  return document(
      {{"reference_frame",
        {{"Levels",
          {{"plate", {{"SpatialAxes", "RAI"}, {"Description", "Origin at the plate's centre; x right, y forward, z along the load"}}}}}}}});
}

std::string motion_description(const Recording& recording, const StreamInfo& stream, const MotionFacts& facts) {
  const SessionFacts session = recording.session().value_or(SessionFacts{});
  std::uint32_t positions = 0;
  std::set<std::string> points;
  for (const ChannelInfo& channel : stream.channels) {
    const ChannelMotion motion = motion_of(stream, channel);
    if (motion.type != "POS") continue;
    ++positions;
    points.insert(motion.point);
  }
  const auto channels = static_cast<std::uint32_t>(stream.channels.size());
  Json json{{"TaskName", session.protocol.empty() ? "free" : session.protocol},
            {"SamplingFrequency", stream.rate.value_or(core::Rate{}).hz()},
            {"TrackingSystemName", facts.tracking_system},
            {"MotionChannelCount", channels + 1},
            {"POSChannelCount", positions},
            {"MISCChannelCount", channels - positions},
            {"LATENCYChannelCount", 1},
            {"TrackedPointsCount", points.size()},
            {"RecordingDuration", static_cast<double>(facts.duration_ns) * 1e-9},
            {"MissingValues", "n/a"}};
  if (!session.device_model.empty()) json["ManufacturersModelName"] = session.device_model;
  if (!session.device_serial.empty()) json["DeviceSerialNumber"] = session.device_serial;
  if (!session.software.empty()) json["SoftwareVersions"] = session.software;
  return document(json);
}

std::string events_description() {
  return document({{"onset", {{"Description", "Since the first scan of the recording"}, {"Units", "s"}}},
                   {"duration", {{"Description", "0: a moment; n/a: until the next event of its kind"}, {"Units", "s"}}},
                   {"trial_type",
                    {{"Description", "What happened"},
                     {"Levels",
                      {{"segment", "Scans follow each other without a hole from here on"},
                       {"marker", "Set by the operator"},
                       {"trigger", "Edge on the trigger channel"},
                       {"session", "State of the session"},
                       {"device", "State of the device"},
                       {"trial", "Step of the protocol"},
                       {"loss", "Scans that the recorder was too slow for"}}}}},
                   {"value", {{"Description", "A marker's text, a trial's phase, a state, an edge, the reason of a gap"}}},
                   {"condition", {{"Description", "Of a trial"}}},
                   {"segment", {{"Description", "Number of the stretch without holes"}}},
                   {"scan", {{"Description", "Index of the scan in its segment"}}},
                   {"details", {{"Description", "Everything else, as JSON"}}}});
}

}  // namespace dts::record
