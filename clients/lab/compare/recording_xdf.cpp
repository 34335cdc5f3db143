// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "core/result.h"
#include "files/toml_reader.h"
#include "lab/compare/recording.h"
#include "record/recording.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kMostScans = 10'000'000;
constexpr TriggerLevel kDefaultTrigger{.level = 2.5, .band = 0.5};  ///< As in a rig file without these keys.

/// The columns of the centre of pressure in a file.
struct CopColumns {
  std::size_t stream = 0;
  std::size_t width = 0;
  std::size_t x = 0;
  std::size_t y = 0;
  double rate_hz = 1.0;
  double delay_s = 0.0;  ///< A value describes the moment this long before its time stamp.
};

std::optional<CopColumns> find_cop(const record::Recording& file) {
  const auto stream = file.find_stream("cop");
  if (!stream || !file.streams()[*stream].rate) return std::nullopt;
  const record::StreamInfo& info = file.streams()[*stream];
  const auto x = std::ranges::find(info.channels, "ml_mm", &record::ChannelInfo::label);
  const auto y = std::ranges::find(info.channels, "ap_mm", &record::ChannelInfo::label);
  if (x == info.channels.end() || y == info.channels.end()) return std::nullopt;
  return CopColumns{.stream = *stream,
                    .width = info.channels.size(),
                    .x = static_cast<std::size_t>(x - info.channels.begin()),
                    .y = static_cast<std::size_t>(y - info.channels.begin()),
                    .rate_hz = info.rate->hz(),
                    .delay_s = static_cast<double>(info.delay_ns) * 1e-9};
}

/// The channel of the trigger in "aux".
struct TriggerColumn {
  std::size_t stream = 0;
  std::size_t width = 0;
  std::size_t column = 0;
  double rate_hz = 1.0;
  TriggerLevel level{};
};

/// Finds it by the recorded rig definition; nothing if the rig has no trigger or the stream was not recorded.
std::optional<TriggerColumn> find_trigger(const record::Recording& file) {
  const auto stream = file.find_stream("aux");
  if (!stream || !file.streams()[*stream].rate || !file.session()) return std::nullopt;
  files::Problems ignored;
  const auto definition = files::parse_toml_text(file.session()->rig_definition, "the recorded rig", ignored);
  if (!definition) return std::nullopt;
  const auto channel = definition->at_path("trigger.channel").value<std::int64_t>();
  const record::StreamInfo& info = file.streams()[*stream];
  const auto found = std::ranges::find_if(
      info.channels, [&](const record::ChannelInfo& one) { return channel && one.device_channel == *channel && *channel >= 0; });
  if (found == info.channels.end()) return std::nullopt;
  return TriggerColumn{.stream = *stream,
                       .width = info.channels.size(),
                       .column = static_cast<std::size_t>(found - info.channels.begin()),
                       .rate_hz = info.rate->hz(),
                       .level = {.level = definition->at_path("trigger.level").value_or(kDefaultTrigger.level),
                                 .band = definition->at_path("trigger.hysteresis").value_or(kDefaultTrigger.band)}};
}

struct Event {
  double time_s = 0.0;
  bool is_trigger = false;
  std::string text;
};

/// State of the reading.
struct Reading {
  std::vector<Event> events{};
  std::vector<double> level_s{};  ///< Of the trigger, if it was recorded: time stamps...
  std::vector<double> level{};    ///< ...and values.
  std::uint32_t segment = 0;      ///< Of the last scans.
};

void add_scans(const record::RecordedScans& scans, const CopColumns& cop, Recording& recording, Reading& reading) {
  if (scans.count == 0) return;
  const double first_s = scans.first_time_s - cop.delay_s;
  if (recording.t_s.empty()) {
    recording.began_s = first_s;
  } else if (scans.segment != reading.segment) {
    recording.restarts_s.push_back(first_s - recording.began_s);
  }
  reading.segment = scans.segment;
  for (std::size_t i = 0; i < scans.count; ++i) {
    recording.t_s.push_back((first_s - recording.began_s) + static_cast<double>(i) / cop.rate_hz);
    recording.x_mm.push_back(scans.values[i * cop.width + cop.x]);
    recording.y_mm.push_back(scans.values[i * cop.width + cop.y]);
  }
}

void add_level(const record::RecordedScans& scans, const TriggerColumn& trigger, Reading& reading) {
  for (std::size_t i = 0; i < scans.count; ++i) {
    reading.level_s.push_back(scans.first_time_s + static_cast<double>(i) / trigger.rate_hz);
    reading.level.push_back(scans.values[i * trigger.width + trigger.column]);
  }
}

void add_event(const record::TimedEvent& timed, std::vector<Event>& events) {
  const v1::Event& event = timed.event;
  if (event.has_marker()) events.push_back({.time_s = timed.time_s, .text = event.marker().text()});
  if (event.trigger().edge() == v1::TRIGGER_EDGE_RISING) {
    events.push_back({.time_s = timed.time_s, .is_trigger = true});
  }
}

/// Places each marker at the first scan that is not before it, as in a CSV file. A trigger has risen between its scan and the scan before.
void place_events(std::vector<Event>& events, Recording& recording) {
  if (events.size() > 0) recording.marker.assign(recording.t_s.size(), std::string());
  std::ranges::stable_sort(events, {}, &Event::time_s);
  for (const Event& event : events) {
    const double time_s = event.time_s - recording.began_s;
    if (event.is_trigger) {
      recording.edges_s.push_back(time_s - recording.edge_step_s / 2.0);
      continue;
    }
    const auto at = std::ranges::lower_bound(recording.t_s, time_s);
    if (at != recording.t_s.end()) recording.marker[static_cast<std::size_t>(at - recording.t_s.begin())] = event.text;
  }
}

/// Replaces the edges of the events by those of the recorded values, which are known better than to one scan if the signal rises slowly.
/// Keeps those of the events if the recorded values have no edges.
void set_edges(Reading& reading, const TriggerLevel& level, Recording& recording) {
  for (double& level_s : reading.level_s) level_s -= recording.began_s;
  RisingEdges edges = rising_edges(reading.level_s, reading.level, level);
  if (edges.at_s.empty()) return;
  recording.edges_s = std::move(edges.at_s);
  recording.edge_step_s = edges.step_s;
}

core::Status read_items(record::Recording& file, const CopColumns& cop, Recording& recording) {
  const auto trigger = find_trigger(file);
  Reading reading;
  while (true) {
    DTS_TRY_ASSIGN(const auto item, file.next());
    if (!item) break;
    const auto* scans = std::get_if<record::RecordedScans>(&*item);
    if (scans != nullptr && scans->stream == cop.stream) {
      add_scans(*scans, cop, recording, reading);
    } else if (scans != nullptr && trigger && scans->stream == trigger->stream) {
      add_level(*scans, *trigger, reading);
    } else if (const auto* event = std::get_if<record::TimedEvent>(&*item)) {
      add_event(*event, reading.events);
    }
    if (recording.t_s.size() > kMostScans || reading.events.size() > kMostScans || reading.level.size() > kMostScans) {
      return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostScans) + " scans");
    }
  }
  place_events(reading.events, recording);
  if (trigger) set_edges(reading, trigger->level, recording);
  return {};
}

/// The trigger is a channel of the device, so its events are at raw scans.
double trigger_step_s(const record::Recording& file, const CopColumns& cop) {
  const auto raw = file.find_stream("raw");
  const bool has_rate = raw && file.streams()[*raw].rate;
  return 1.0 / (has_rate ? file.streams()[*raw].rate->hz() : cop.rate_hz);
}

}  // namespace

Recording read_xdf_recording(const std::string& file, files::Problems& problems) {
  Recording recording;
  const auto opened = record::Recording::open(file);
  if (!opened) {
    problems.push_back({.file = file, .text = core::to_string(opened.error())});
    return recording;
  }
  const auto cop = find_cop(**opened);
  if (!cop) {
    problems.push_back({.file = file, .text = "has no stream \"cop\" with channels ml_mm and ap_mm; dtslab replay lists its streams"});
    return recording;
  }
  recording.delay_s = cop->delay_s;
  recording.edge_step_s = trigger_step_s(**opened, *cop);
  if (const auto& session = (*opened)->session()) {
    recording.host_clock = session->boot_id;
    recording.is_simulated = session->device_uri.starts_with("sim:");
  }
  if (const auto read = read_items(**opened, *cop, recording); !read) {
    problems.push_back({.file = file, .text = core::to_string(read.error())});
  }
  return recording;
}

}  // namespace dts::lab::compare
