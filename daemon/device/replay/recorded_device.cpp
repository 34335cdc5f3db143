// SPDX-License-Identifier: Apache-2.0
#include "device/replay/recorded_device.h"

#include <algorithm>
#include <charconv>
#include <string>
#include <utility>
#include <variant>

namespace dts::device::replay {
namespace {

constexpr double kRateTolerance = 0.005;  // a rig is configured with 1500 Hz, but its DAQ ran at 1501.5 Hz: use the recorded rate
constexpr double kUnknownRange = 1e6;     // range of a channel of unknown range: so wide that no value counts as rail
constexpr std::size_t kMostNumbers = 1U << 24U;

tl::unexpected<core::Error> refuse(const std::string& uri, const std::string& why) {
  return core::fail(core::ErrorCode::InvalidArgument, uri + " cannot be replayed: " + why,
                    "choose a recording of dtsd: only these contain the channel numbers of the device");
}

ChannelDescription describe(const record::ChannelInfo& channel, bool is_raw) {
  ChannelDescription description{.name = channel.label, .unit = channel.unit, .role = ChannelRole::Auxiliary};
  if (is_raw && channel.is_sensor) description.role = ChannelRole::Sensor;
  if (channel.is_marker) description.role = ChannelRole::Marker;
  const bool is_known = channel.minimum < channel.maximum;
  description.minimum = is_known ? channel.minimum : -kUnknownRange;
  description.maximum = is_known ? channel.maximum : kUnknownRange;
  description.resolution = channel.resolution >= 0.0 ? channel.resolution : 0.0;
  return description;
}

/// Assigns the channels of one stream to device channels; returns the problem, or an empty text.
std::string place(const record::StreamInfo& stream, bool is_raw, DeviceDescription& device, std::vector<std::size_t>& columns) {
  for (const record::ChannelInfo& channel : stream.channels) {
    if (channel.device_channel < 0) return "channel " + channel.label + " of stream " + stream.name + " has no device channel";
    const auto at = static_cast<std::size_t>(channel.device_channel);
    if (at >= device.channels.size()) return "channel " + std::to_string(at) + " is recorded, but a channel below it is not";
    if (!device.channels[at].name.empty()) return "device channel " + std::to_string(at) + " is recorded twice";
    device.channels[at] = describe(channel, is_raw);
    if (device.channels[at].name.empty()) device.channels[at].name = "ch" + std::to_string(at);
    columns.push_back(at);
  }
  return {};
}

std::string place_all(const record::Recording& recording, RecordedDevice& found) {
  const record::StreamInfo& raw = recording.streams()[found.raw_stream];
  const record::StreamInfo* const aux = found.aux_stream ? &recording.streams()[*found.aux_stream] : nullptr;
  const std::size_t channels = raw.channels.size() + (aux != nullptr ? aux->channels.size() : 0);
  if (raw.channels.empty() || channels > core::kMaxChannels) return "it has " + std::to_string(channels) + " channels";
  found.description.channels.resize(channels);
  std::string problem = place(raw, true, found.description, found.raw_channels);
  if (problem.empty() && aux != nullptr) problem = place(*aux, false, found.description, found.aux_channels);
  return problem;
}

void name_device(const record::Recording& recording, DeviceDescription& description) {
  const auto& session = recording.session();
  description.model = session ? session->device_model : std::string();
  description.serial = session ? session->device_serial : std::string();
  if (description.model.empty()) description.model = "Recording";
  if (description.serial.empty()) description.serial = session && !session->session_id.empty() ? session->session_id : "recording";
}

}  // namespace

core::Result<std::vector<double>> parse_state(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (*at == ' ') {
      ++at;
      continue;
    }
    double value = 0.0;
    const auto [stopped_at, error] = std::from_chars(at, end, value);
    if (error != std::errc{} || (stopped_at != end && *stopped_at != ' ') || numbers.size() == kMostNumbers) {
      return core::fail(core::ErrorCode::DataDamaged,
                        "the recorded state of the stages is not a list of numbers: wrong at number " + std::to_string(numbers.size() + 1));
    }
    numbers.push_back(value);
    at = stopped_at;
  }
  return numbers;
}

core::Result<RecordedDevice> find_device(const record::Recording& recording, const std::string& uri) {
  RecordedDevice found;
  const auto raw = recording.find_stream("raw");
  if (!raw || !recording.streams()[*raw].rate) return refuse(uri, "it has no stream \"raw\" of regular samples");
  const record::StreamInfo& raw_info = recording.streams()[*raw];
  found.raw_stream = *raw;
  found.rate = *raw_info.rate;
  found.aux_stream = recording.find_stream("aux");
  if (found.aux_stream && recording.streams()[*found.aux_stream].rate != raw_info.rate) {
    return refuse(uri, "its streams \"raw\" and \"aux\" have different rates");
  }
  if (const std::string problem = place_all(recording, found); !problem.empty()) return refuse(uri, problem);
  found.quality_stream = recording.find_stream("quality");
  const std::size_t channels = found.description.channels.size();
  if (found.quality_stream && recording.streams()[*found.quality_stream].channels.size() != channels) {
    return refuse(uri, "its stream \"quality\" does not have the channels of \"raw\" and \"aux\"");
  }
  name_device(recording, found.description);
  found.description.uri = uri;
  found.description.minimum_rate_hz = found.rate.hz() * (1.0 - kRateTolerance);
  found.description.maximum_rate_hz = found.rate.hz() * (1.0 + kRateTolerance);
  found.description.waits_for_reader = true;
  if (recording.session()) found.description.recorded_pipeline.stages = recording.session()->stages;
  auto state = parse_state(record::fact(raw_info.facts, "stage_state"));
  if (!state) return core::fail(state.error().code, uri + ": " + state.error().what);
  found.description.recorded_pipeline.state = std::move(*state);
  return found;
}

core::Status find_first_scan(record::Recording& recording, RecordedDevice& device) {
  DTS_TRY(recording.rewind());
  while (true) {
    DTS_TRY_ASSIGN(const auto item, recording.next());
    if (!item) break;
    const auto* scans = std::get_if<record::RecordedScans>(&*item);
    if (scans == nullptr || scans->stream != device.raw_stream) continue;
    if (device.rate.time_ns(scans->first_scan) > kFarthestNs) {
      return core::fail(core::ErrorCode::DataDamaged,
                        device.description.uri + ": its first scan has the impossible index " + std::to_string(scans->first_scan.value));
    }
    device.description.recorded_pipeline.first_scan = scans->first_scan.value;
    break;
  }
  return recording.rewind();
}

}  // namespace dts::device::replay
