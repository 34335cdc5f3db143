// SPDX-License-Identifier: Apache-2.0
#include "record/export/walk.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "record/export/lanes.h"

namespace dts::record {
namespace {

constexpr std::uint64_t kReportEveryBytes = 4U << 20U;
constexpr std::size_t kLongestName = 100;
constexpr std::size_t kMostLanes = 4;  // a recording has at most this many large streams

/// Collects the times of the first scans until every regular stream has one.
class Beginnings {
 public:
  explicit Beginnings(const Recording& recording) : waits_for_(recording.streams().size(), false) {
    for (std::size_t stream = 0; stream < waits_for_.size(); ++stream) {
      waits_for_[stream] = recording.streams()[stream].rate.has_value() && recording.sample_count(stream) > 0;
    }
  }
  [[nodiscard]] bool is_complete() const {
    return std::ranges::none_of(waits_for_, [](bool waits) { return waits; });
  }
  void add(const RecordedItem& item) {
    if (const auto* scans = std::get_if<RecordedScans>(&item)) {
      first_scan_s_ = std::min(first_scan_s_.value_or(scans->first_time_s), scans->first_time_s);
      if (scans->stream < waits_for_.size()) waits_for_[scans->stream] = false;
    } else if (!first_other_s_) {
      first_other_s_ = std::visit(TimeOf{}, item);
    }
  }
  [[nodiscard]] double origin_s() const {
    const double origin_s = first_scan_s_.value_or(first_other_s_.value_or(0.0));
    return std::isfinite(origin_s) ? origin_s : 0.0;
  }

 private:
  struct TimeOf {
    double operator()(const RecordedScans& scans) const { return scans.first_time_s; }
    template <class Item>
    double operator()(const Item& item) const {
      return item.time_s;
    }
  };

  std::vector<bool> waits_for_;
  std::optional<double> first_scan_s_{};
  std::optional<double> first_other_s_{};
};

/// Returns false if an item does not match its stream. That would be our bug; this check prevents an access out of bounds.
bool fits(const Recording& recording, const RecordedItem& item) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) {
    return scans->stream < recording.streams().size() &&
           scans->values.size() == scans->count * recording.streams()[scans->stream].channels.size();
  }
  if (const auto* change = std::get_if<RecordedChange>(&item)) {
    return change->stream < recording.streams().size() && change->values.size() == recording.streams()[change->stream].channels.size();
  }
  return true;
}

core::Status hand_over(const RecordedItem& item, ExportSink& sink) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) return sink.write(*scans);
  if (const auto* change = std::get_if<RecordedChange>(&item)) return sink.write(*change);
  if (const auto* event = std::get_if<TimedEvent>(&item)) return sink.write(*event);
  return {};
}

/// Assigns every stream to a lane: the largest stream first, and each to the lane with the least work so far.
std::vector<std::size_t> share_out(const Recording& recording, std::size_t lanes) {
  std::vector<std::pair<double, std::size_t>> weights;
  for (std::size_t stream = 0; stream < recording.streams().size(); ++stream) {
    const StreamInfo& info = recording.streams()[stream];
    const double digits = info.value_type == ValueType::Double64 ? 2.0 : 1.0;
    weights.emplace_back(digits * static_cast<double>(info.channels.size()) * static_cast<double>(recording.sample_count(stream)), stream);
  }
  std::ranges::sort(weights, std::greater<>());
  std::vector<double> loads(lanes, 0.0);
  std::vector<std::size_t> lane_of(weights.size());
  for (const auto& [weight, stream] : weights) {
    const auto least = std::ranges::min_element(loads);
    *least += weight;
    lane_of[stream] = static_cast<std::size_t>(least - loads.begin());
  }
  return lane_of;
}

std::size_t lane_of(const RecordedItem& item, const std::vector<std::size_t>& lanes) {
  if (const auto* scans = std::get_if<RecordedScans>(&item)) return lanes[scans->stream];
  if (const auto* change = std::get_if<RecordedChange>(&item)) return lanes[change->stream];
  return 0;  // events use lane 0
}

std::size_t usual_lanes() { return std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kMostLanes); }

}  // namespace

core::Result<double> find_origin(Recording& recording) {
  DTS_TRY(recording.rewind());
  Beginnings beginnings(recording);
  for (bool is_first = true; is_first || !beginnings.is_complete(); is_first = false) {
    DTS_TRY_ASSIGN(const auto item, recording.next());
    if (!item) break;
    beginnings.add(*item);
  }
  return recording.rewind().map([&] { return beginnings.origin_s(); });
}

core::Status walk(Recording& recording, ExportSink& sink, const Progress& progress) {
  DTS_TRY(recording.rewind());
  Lanes lanes(usual_lanes(), [&sink](const RecordedItem& item) { return hand_over(item, sink); });
  const std::vector<std::size_t> shares = share_out(recording, lanes.count());
  std::uint64_t reported = 0;
  while (!lanes.has_failed()) {
    DTS_TRY_ASSIGN(auto item, recording.next());
    if (!item) break;
    if (!fits(recording, *item)) return core::fail(core::ErrorCode::Internal, "a recorded item does not fit its stream");
    lanes.give(lane_of(*item, shares), std::move(*item));
    if (!progress || recording.offset() - reported < kReportEveryBytes) continue;
    reported = recording.offset();
    if (!progress(reported, recording.size()))
      return core::fail(core::ErrorCode::Failed, "stopped: nothing of this recording was exported");
  }
  return lanes.finish();
}

std::string fit_for_file_name(const std::string& text) {
  std::string name = text.substr(0, kLongestName);
  std::ranges::replace_if(
      name,
      [](char letter) {
        const bool is_letter = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') || (letter >= '0' && letter <= '9');
        return !is_letter && letter != '.' && letter != '_' && letter != '-';
      },
      '_');
  if (name.starts_with('.')) name.front() = '_';
  return name;
}

std::string file_stem(const Recording& recording) {
  const auto& session = recording.session();
  if (!session || session->session_id.empty()) return "recording";
  const std::string part = session->part > 1 ? "." + std::to_string(session->part) : "";
  return fit_for_file_name(session->session_id) + part;
}

}  // namespace dts::record
