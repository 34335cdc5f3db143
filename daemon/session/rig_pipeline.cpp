// SPDX-License-Identifier: Apache-2.0
#include "session/rig_pipeline.h"

#include <algorithm>
#include <string>
#include <utility>

namespace dts::session {
namespace {

/// Returns the error of a rig whose device has fewer channels than its sensors or its force plate need.
core::Error too_few_channels(const pipeline::RigConfig& config, const device::DeviceDescription& device, std::size_t channel) {
  const std::string has = ", but " + device.uri + " has " + std::to_string(device.channels.size()) + " channels";
  const std::string rig = "rig '" + config.name + "': ";
  if (!config.model.force_plate) {
    return {.code = core::ErrorCode::InvalidArgument, .what = rig + "a sensor is on channel " + std::to_string(channel) + has, .hint = {}};
  }
  const std::size_t needed = std::ranges::max(config.sensor_channels) + 1;
  std::string inputs = "0";
  for (std::size_t input = 1; input < needed; ++input) inputs += "," + std::to_string(input);
  return {.code = core::ErrorCode::InvalidArgument,
          .what = rig + "the force plate needs " + std::to_string(needed) + " channels" + has,
          .hint = "write all inputs into the address of the DAQ: channels=" + inputs};
}

core::Result<pipeline::PipelineInput> describe_input(const pipeline::RigConfig& config, const device::DeviceDescription& device) {
  pipeline::PipelineInput input{.rate = config.rate,
                                .sensor_channels = config.sensor_channels,
                                .aux_channels = {},
                                .aux_formats = {},
                                .trigger = config.trigger,
                                .max_block_scans = config.block_scans};
  for (const std::size_t channel : config.sensor_channels) {
    if (channel >= device.channels.size()) return tl::make_unexpected(too_few_channels(config, device, channel));
  }
  for (std::size_t channel = 0; channel < device.channels.size(); ++channel) {
    if (std::ranges::find(config.sensor_channels, channel) != config.sensor_channels.end()) continue;
    input.aux_channels.push_back(channel);
    input.aux_formats.push_back({.name = device.channels[channel].name, .unit = device.channels[channel].unit});
  }
  return input;
}

std::vector<pipeline::StageContext::InputRange> input_ranges(const pipeline::RigConfig& config, const device::DeviceDescription& device) {
  std::vector<pipeline::StageContext::InputRange> ranges;
  for (const std::size_t channel : config.sensor_channels) {
    const auto& described = device.channels[channel];
    ranges.push_back({.minimum_v = described.minimum, .maximum_v = described.maximum, .resolution_v = described.resolution});
  }
  return ranges;
}

/// Returns the kind of quantity, in the words of the XDF wiki.
std::string channel_type(const std::string& unit) {
  if (unit == "V") return "Voltage";
  if (unit == "mm") return "Position";
  return unit == "N" ? "Force" : "Misc";
}

record::ChannelInfo device_channel(const core::ChannelFormat& format, const device::DeviceDescription& device, std::size_t channel) {
  const device::ChannelDescription& described = device.channels.at(channel);
  return {.label = format.name,
          .unit = format.unit,
          .type = channel_type(format.unit),
          .device_channel = static_cast<int>(channel),
          .minimum = described.minimum,
          .maximum = described.maximum,
          .resolution = described.resolution,
          .is_sensor = described.role == device::ChannelRole::Sensor,
          .is_marker = described.role == device::ChannelRole::Marker};
}

/// Returns the device channels of the columns of "raw" and "aux", in order: the sensors as configured, then the others in device order.
std::vector<std::size_t> device_channels(const pipeline::RigConfig& config, const device::DeviceDescription& device,
                                         const std::string& stream) {
  if (stream == "raw") return config.sensor_channels;
  std::vector<std::size_t> others;
  for (std::size_t channel = 0; stream == "aux" && channel < device.channels.size(); ++channel) {
    if (std::ranges::find(config.sensor_channels, channel) == config.sensor_channels.end()) others.push_back(channel);
  }
  return others;
}

record::StreamInfo stream_info(const pipeline::RigConfig& config, const device::DeviceDescription& device,
                               const core::StreamFormat& format) {
  const bool is_measured = format.name == "raw" || format.name == "aux";
  record::StreamInfo info{.name = config.name + "/" + format.name,
                          .content = "DTS",
                          .value_type = is_measured ? record::ValueType::Double64 : record::ValueType::Float32,
                          .rate = format.rate,
                          .channels = {},
                          .delay_ns = format.delay_ns};
  const std::vector<std::size_t> channels = device_channels(config, device, format.name);
  for (std::size_t c = 0; c < format.channels.size(); ++c) {
    const core::ChannelFormat& channel = format.channels[c];
    info.channels.push_back(is_measured && c < channels.size()
                                ? device_channel(channel, device, channels[c])
                                : record::ChannelInfo{.label = channel.name, .unit = channel.unit, .type = channel_type(channel.unit)});
  }
  return info;
}

}  // namespace

std::vector<record::RecordedStream> recorded_streams(const pipeline::RigConfig& config, const device::DeviceDescription& device,
                                                     std::span<const core::StreamFormat> formats) {
  std::vector<record::RecordedStream> streams;
  for (std::size_t index = 0; index < formats.size(); ++index) {
    const std::string& name = formats[index].name;
    const bool is_needed = name == "raw" || name == "aux";
    if (!is_needed && !config.recorded.empty() && std::ranges::find(config.recorded, name) == config.recorded.end()) continue;
    streams.push_back({.frame_index = index, .info = stream_info(config, device, formats[index])});
  }
  return streams;
}

core::Result<RigPipeline> make_rig_pipeline(const pipeline::RigConfig& config, const device::DeviceDescription& device) {
  DTS_TRY_ASSIGN(const auto input, describe_input(config, device));
  auto tare = std::make_unique<pipeline::Tare>();
  auto windows = std::make_unique<pipeline::SteadinessWindows>();
  auto stances = std::make_unique<pipeline::SubjectStances>();
  DTS_TRY_ASSIGN(auto pipeline, pipeline::Pipeline::create(config.stages, input,
                                                           {.rig = config.model,
                                                            .input_ranges = input_ranges(config, device),
                                                            .tare = *tare,
                                                            .windows = *windows,
                                                            .cop_calibration = config.cop_calibration ? &*config.cop_calibration : nullptr,
                                                            .trunk_model = config.trunk_model ? &*config.trunk_model : nullptr,
                                                            .stances = stances.get()}));
  return RigPipeline{
      .tare = std::move(tare), .windows = std::move(windows), .stances = std::move(stances), .pipeline = std::move(pipeline)};
}

core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device, std::uint32_t segment,
                                        core::ScanIndex next_scan) {
  const device::RecordedPipeline& recorded = device.recorded_pipeline;
  if (recorded.stages.empty() || recorded.state.empty()) return Restored::NoRecording;
  if (recorded.stages != pipeline.stage_texts()) return Restored::OtherStages;
  if (auto restored = pipeline.restore(recorded.state, segment, next_scan); !restored) {
    return core::fail(restored.error().code, device.uri + ": " + restored.error().what);
  }
  return Restored::Done;
}

core::Result<Restored> restore_recorded(pipeline::Pipeline& pipeline, const device::DeviceDescription& device) {
  return restore_recorded(pipeline, device, 0, {device.recorded_pipeline.first_scan});
}

}  // namespace dts::session
