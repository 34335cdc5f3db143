// SPDX-License-Identifier: Apache-2.0
#include "lab/replay/replay.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "device/replay/recorded_device.h"
#include "device/replay/scan_merger.h"
#include "lab/replay/event_check.h"
#include "session/rig_pipeline.h"
#include "session/session_events.h"
#include "session/trial_stance.h"

namespace dts::lab::replay {
namespace {

using device::replay::RecordedDevice;
using device::replay::ScanMerger;

constexpr std::size_t kReplayedScans = 256;                   // results do not depend on it: the contract of the stages
constexpr std::int64_t kFarthestNs = std::int64_t{1} << 61U;  // 73 years: prevents overflow by a large index in a file

/// Mean and last value of each channel of one stream.
class Summary {
 public:
  explicit Summary(const core::StreamFormat& format) : sums_(format.channels.size()) {
    for (const core::ChannelFormat& channel : format.channels) channels_.push_back({.name = channel.name});
  }

  void add(const core::Block& block) {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      for (const double value : block.column(c)) {
        if (std::isnan(value)) continue;
        sums_[c].sum += value;
        ++sums_[c].count;
        channels_[c].last = value;
      }
    }
  }
  [[nodiscard]] std::vector<ChannelSummary> finish() {
    for (std::size_t c = 0; c < channels_.size(); ++c) {
      if (sums_[c].count > 0) channels_[c].mean = sums_[c].sum / static_cast<double>(sums_[c].count);
    }
    return channels_;
  }

 private:
  struct Sum {
    double sum = 0.0;
    std::uint64_t count = 0;
  };
  std::vector<ChannelSummary> channels_;
  std::vector<Sum> sums_;
};

/// One running replay.
class Replay {
 public:
  Replay(record::Recording& recording, const RecordedDevice& device, session::RigPipeline& rig);

  core::Status run(const std::function<void(double)>& progress);
  [[nodiscard]] ReplayReport finish();

 private:
  core::Status process_item(const record::RecordedItem& item);
  void process_event(const v1::Event& event);
  core::Status process_ready();
  core::Status begin(const core::Block& block);
  void process();

  record::Recording& recording_;
  const RecordedDevice& device_;
  session::RigPipeline& rig_;
  ScanMerger merger_;
  core::Acquired acquired_;
  core::Frame frame_;
  core::Gap gap_;
  std::optional<std::uint32_t> segment_;
  std::vector<std::unique_ptr<StreamCheck>> checks_by_stream_;  ///< One per recorded stream; nullptr: not a derived stream.
  std::vector<StreamCheck*> checks_by_frame_;
  EventCheck events_;
  std::vector<std::optional<Summary>> summaries_;
  ReplayReport report_;
};

Replay::Replay(record::Recording& recording, const RecordedDevice& device, session::RigPipeline& rig)
    : recording_(recording),
      device_(device),
      rig_(rig),
      merger_(device),
      acquired_{.block = core::Block(device.description.channels.size(), kReplayedScans)},
      frame_(rig.pipeline->make_frame()),
      checks_by_stream_(recording.streams().size()) {
  for (const core::StreamFormat& format : rig.pipeline->formats()) {
    const bool is_derived = format.name != "raw" && format.name != "aux";
    const auto stream = recording.find_stream(format.name);
    const bool is_comparable = is_derived && stream && recording.streams()[*stream].channels.size() == format.channels.size() &&
                               recording.streams()[*stream].rate == format.rate;
    if (is_comparable) checks_by_stream_[*stream] = std::make_unique<StreamCheck>(recording.streams()[*stream]);
    checks_by_frame_.push_back(is_comparable ? checks_by_stream_[*stream].get() : nullptr);
    summaries_.push_back(format.name == "cop" ? std::optional<Summary>(format) : std::nullopt);
    if (is_derived && stream && !is_comparable) {
      report_.streams.push_back({.name = recording.streams()[*stream].name,
                                 .difference = Difference{.recorded = "other channels or rate", .computed = "those of the rig"}});
    }
  }
}

core::Status Replay::run(const std::function<void(double)>& progress) {
  while (true) {
    DTS_TRY_ASSIGN(auto item, recording_.next());
    if (!item) break;
    DTS_TRY(process_item(*item));
    progress(static_cast<double>(recording_.offset()) / static_cast<double>(std::max<std::uint64_t>(recording_.size(), 1)));
  }
  merger_.finish();
  return process_ready();
}

core::Status Replay::process_item(const record::RecordedItem& item) {
  if (const auto* scans = std::get_if<record::RecordedScans>(&item)) {
    if (StreamCheck* check = checks_by_stream_[scans->stream].get()) check->add_recorded(*scans);
  }
  if (const auto* timed = std::get_if<record::TimedEvent>(&item)) process_event(timed->event);
  DTS_TRY(merger_.add(item));
  return process_ready();
}

/// Announces to the stages what the daemon announced. A trial is in the file before the scan from which its stance is valid.
void Replay::process_event(const v1::Event& event) {
  events_.add_recorded(event);
  if (!event.has_trial()) return;
  const auto trial = session::trial_of(event);
  if (trial) session::announce_feet(*rig_.stances, *trial, event.segment(), {event.scan()}, device_.rate);
}

core::Status Replay::process_ready() {
  while (true) {
    switch (merger_.take(acquired_.block, gap_)) {
      case ScanMerger::Taken::Nothing: return {};
      case ScanMerger::Taken::Gap: acquired_.gap_before = gap_; break;
      case ScanMerger::Taken::Scans:
        DTS_TRY(begin(acquired_.block));
        process();
        break;
    }
  }
}

core::Status Replay::begin(const core::Block& block) {
  if (!segment_) {
    DTS_TRY_ASSIGN(const auto restored, session::restore_recorded(*rig_.pipeline, device_.description, block.segment, block.first_scan));
    report_.is_restored = restored == session::Restored::Done;
    if (restored == session::Restored::OtherStages) {
      report_.notes.emplace_back("the stages of the rig differ from the recorded stages: they start without history");
    } else if (restored == session::Restored::NoRecording) {
      report_.notes.emplace_back("the recording does not contain the state of the stages at its start: they start without history");
    }
  }
  if (acquired_.gap_before.reason != core::GapReason::None && segment_ == block.segment) {
    report_.notes.emplace_back("the recorder lost scans at scan " + std::to_string(block.first_scan.value) + " of segment " +
                               std::to_string(block.segment) + ": later scans are not compared");
    for (const auto& check : checks_by_stream_) {
      if (check) check->stop();
    }
    events_.stop();
  }
  if (segment_ != block.segment) ++report_.segments;
  segment_ = block.segment;
  return {};
}

void Replay::process() {
  const core::Block& block = acquired_.block;
  acquired_.block.host_time_ns = std::min(device_.rate.time_ns(block.first_scan), kFarthestNs);
  rig_.pipeline->process(acquired_, frame_);
  events_.add_computed(rig_.pipeline->events());
  acquired_.gap_before = {};
  report_.scans += block.count();
  for (std::size_t s = 0; s < frame_.streams.size(); ++s) {
    if (checks_by_frame_[s] != nullptr) checks_by_frame_[s]->add_computed(frame_.streams[s]);
    if (summaries_[s]) summaries_[s]->add(frame_.streams[s]);
  }
}

ReplayReport Replay::finish() {
  for (StreamCheck* check : checks_by_frame_) {
    if (check == nullptr) continue;
    check->finish(!recording_.damage().empty());
    report_.streams.push_back({.name = check->name(), .scans = check->compared_scans(), .difference = check->difference()});
  }
  events_.finish(!recording_.damage().empty());
  if (events_.compared() > 0 || events_.difference()) {
    report_.streams.push_back({.name = "reaches and classes", .scans = events_.compared(), .difference = events_.difference()});
  }
  for (auto& summary : summaries_) {
    if (summary) report_.cop = summary->finish();
  }
  if (!report_.is_identical()) report_.notes.emplace_back("the recording has no derived stream: nothing to compare");
  return std::move(report_);
}

}  // namespace

std::optional<bool> ReplayReport::is_identical() const {
  if (std::ranges::any_of(streams, [](const ComparedStream& stream) { return stream.difference.has_value(); })) return false;
  const bool has_compared = std::ranges::any_of(streams, [](const ComparedStream& stream) { return stream.scans > 0; });
  return has_compared ? std::optional(true) : std::nullopt;
}

core::Result<ReplayReport> replay(record::Recording& recording, pipeline::RigConfig config, const std::string& name,
                                  const core::Clock& clock, const std::function<void(double)>& progress) {
  DTS_TRY_ASSIGN(const auto device, device::replay::find_device(recording, name));
  config.rate = device.rate;
  config.block_scans = kReplayedScans;
  DTS_TRY_ASSIGN(auto rig, session::make_rig_pipeline(config, device.description));
  const std::int64_t begun_ns = clock.now_ns();
  Replay under_way(recording, device, rig);
  DTS_TRY(under_way.run(progress));
  ReplayReport report = under_way.finish();
  report.duration_s = static_cast<double>(clock.now_ns() - begun_ns) * 1e-9;
  return report;
}

}  // namespace dts::lab::replay
