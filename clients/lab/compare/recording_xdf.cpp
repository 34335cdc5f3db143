// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "core/result.h"
#include "lab/compare/recording.h"
#include "record/recording.h"

namespace dts::lab::compare {
namespace {

constexpr std::size_t kMostScans = 10'000'000;

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

struct Event {
  double time_s = 0.0;
  bool is_trigger = false;
  std::string text;
};

void add_scans(const record::RecordedScans& scans, const CopColumns& cop, Recording& recording) {
  if (recording.t_s.empty() && scans.count > 0) recording.began_s = scans.first_time_s - cop.delay_s;
  for (std::size_t i = 0; i < scans.count; ++i) {
    recording.t_s.push_back((scans.first_time_s - cop.delay_s - recording.began_s) + static_cast<double>(i) / cop.rate_hz);
    recording.x_mm.push_back(scans.values[i * cop.width + cop.x]);
    recording.y_mm.push_back(scans.values[i * cop.width + cop.y]);
  }
}

void add_event(const record::TimedEvent& timed, std::vector<Event>& events) {
  const v1::Event& event = timed.event;
  if (event.has_marker()) events.push_back({.time_s = timed.time_s, .text = event.marker().text()});
  if (event.trigger().edge() == v1::TRIGGER_EDGE_RISING) {
    events.push_back({.time_s = timed.time_s, .is_trigger = true});
  }
}

/// Places each event at the first scan that is not before the event, as in a CSV file; a trigger is one scan with a high level.
void place_events(const std::vector<Event>& events, Recording& recording) {
  const bool has_triggers = std::ranges::any_of(events, &Event::is_trigger);
  if (has_triggers) recording.trigger.assign(recording.t_s.size(), 0.0);
  if (events.size() > 0) recording.marker.assign(recording.t_s.size(), std::string());
  for (const Event& event : events) {
    const auto at = std::ranges::lower_bound(recording.t_s, event.time_s - recording.began_s);
    if (at == recording.t_s.end()) continue;
    const auto row = static_cast<std::size_t>(at - recording.t_s.begin());
    if (event.is_trigger) {
      recording.trigger[row] = 1.0;
    } else {
      recording.marker[row] = event.text;
    }
  }
}

core::Status read_items(record::Recording& file, const CopColumns& cop, Recording& recording) {
  std::vector<Event> events;
  while (true) {
    DTS_TRY_ASSIGN(const auto item, file.next());
    if (!item) break;
    if (const auto* scans = std::get_if<record::RecordedScans>(&*item); scans != nullptr && scans->stream == cop.stream) {
      add_scans(*scans, cop, recording);
    } else if (const auto* event = std::get_if<record::TimedEvent>(&*item)) {
      add_event(*event, events);
    }
    if (recording.t_s.size() > kMostScans || events.size() > kMostScans) {
      return core::fail(core::ErrorCode::LimitExceeded, "more than " + std::to_string(kMostScans) + " scans");
    }
  }
  place_events(events, recording);
  return {};
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
  if (const auto read = read_items(**opened, *cop, recording); !read) {
    problems.push_back({.file = file, .text = core::to_string(read.error())});
  }
  return recording;
}

}  // namespace dts::lab::compare
