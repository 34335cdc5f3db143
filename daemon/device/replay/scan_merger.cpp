// SPDX-License-Identifier: Apache-2.0
#include "device/replay/scan_merger.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace dts::device::replay {
namespace {

constexpr double kLagMs = 1000.0;
constexpr std::uint64_t kMostWaitingValues = std::uint64_t{1} << 23U;  // 64 MB; limits a file with only raw or only aux scans
constexpr std::size_t kMostWaitingRuns = std::size_t{1} << 17U;        // limits a file with one scan per chunk
constexpr std::size_t kMostWaitingEvents = 1'000'000;
constexpr std::uint64_t kMostMissingScans = 1'000'000'000'000'000;

core::Status damaged(std::string what) { return core::fail(core::ErrorCode::DataDamaged, std::move(what)); }

}  // namespace

ScanMerger::ScanMerger(const RecordedDevice& device)
    : device_(device),
      lag_scans_(static_cast<std::size_t>(device.rate.scans_in_ms(kLagMs))),
      raw_{.channels = device.raw_channels},
      aux_{.channels = device.aux_channels},
      bits_(device.description.channels.size()) {}

core::Status ScanMerger::add(const record::RecordedItem& item) {
  if (const auto* scans = std::get_if<record::RecordedScans>(&item)) {
    if (scans->stream == device_.raw_stream) return add_scans(*scans, raw_);
    if (device_.aux_stream && scans->stream == *device_.aux_stream) return add_scans(*scans, aux_);
  } else if (const auto* change = std::get_if<record::RecordedChange>(&item)) {
    if (device_.quality_stream && change->stream == *device_.quality_stream) return add_change(*change);
  } else if (const auto* event = std::get_if<record::TimedEvent>(&item)) {
    if (event->event.has_segment_start()) add_segment(event->event);
  }
  return {};
}

core::Status ScanMerger::add_scans(const record::RecordedScans& scans, Column& column) {
  if (scans.count == 0) return {};
  if (scans.values.size() != scans.count * column.channels.size())
    return damaged("the number of values in a chunk of samples does not fit its stream");
  const Place first{scans.segment, scans.first_scan.value};
  if (!column.runs.empty()) {
    const Run& last = column.runs.back();
    if (first < Place{last.first.segment, last.first.scan + last.count}) {
      return damaged("scan " + std::to_string(first.scan) + " of segment " + std::to_string(first.segment) + " appears twice");
    }
  }
  column.runs.push_back(
      {.first = first, .first_time_s = scans.first_time_s, .count = scans.count, .left = scans.count, .values = scans.values});
  column.waiting_scans += scans.count;
  DTS_TRY(align_aux());
  if (is_too_much()) return damaged("the stream \"aux\" does not belong to the stream \"raw\"");
  return {};
}

bool ScanMerger::is_too_much() const noexcept {
  const std::uint64_t values = raw_.waiting_scans * raw_.channels.size() + aux_.waiting_scans * aux_.channels.size();
  return values > kMostWaitingValues || raw_.runs.size() + aux_.runs.size() > kMostWaitingRuns;
}

/// Skips aux scans before the first raw scan: a recording may begin anywhere. Fails if aux scans are missing for a raw scan.
core::Status ScanMerger::align_aux() {
  if (!device_.aux_stream || raw_.runs.empty()) return {};
  const Place next = raw_.runs.front().next();
  while (!aux_.runs.empty() && aux_.runs.front().next() < next) {
    Run& run = aux_.runs.front();
    const bool reaches_it = run.first.segment == next.segment && run.first.scan + run.count > next.scan;
    const std::size_t left = reaches_it ? static_cast<std::size_t>(run.first.scan + run.count - next.scan) : 0;
    aux_.waiting_scans -= run.left - left;
    run.left = left;
    if (left == 0) aux_.runs.pop_front();
  }
  if (aux_.runs.empty() || aux_.runs.front().next() == next) return {};
  return damaged("the stream \"aux\" lacks scan " + std::to_string(next.scan) + " of segment " + std::to_string(next.segment));
}

core::Status ScanMerger::add_change(const record::RecordedChange& change) {
  const Place at{change.segment, change.scan.value};
  if (change.values.size() != bits_.size()) return damaged("the number of values in a quality sample does not fit the channels");
  if (expected_ && at < *expected_) {
    return damaged("the quality of scan " + std::to_string(at.scan) + " appears more than a second after it");
  }
  if (changes_.size() >= kMostWaitingEvents) return damaged("more quality samples than scans");
  Change kept{.at = at, .bits = std::vector<std::uint8_t>(bits_.size())};
  for (std::size_t column = 0; column < bits_.size(); ++column) {
    const double value = change.values[column];
    if (!(value >= -128.0 && value <= 255.0)) return damaged("a quality sample is out of range");
    const bool is_raw = column < raw_.channels.size();
    const std::size_t channel = is_raw ? raw_.channels[column] : aux_.channels[column - raw_.channels.size()];
    kept.bits[channel] = static_cast<std::uint8_t>(static_cast<int>(value) & 0xFF);
  }
  changes_.push_back(std::move(kept));
  return {};
}

void ScanMerger::add_segment(const v1::Event& event) {
  const v1::SegmentStart& start = event.segment_start();
  const bool is_known = start.reason() > 0 && static_cast<std::size_t>(start.reason()) < core::kGapReasons;
  if (!is_known || gaps_.size() >= kMostWaitingEvents) return;
  gaps_[event.segment()] = {.reason = static_cast<core::GapReason>(start.reason()),
                            .missing_scans = std::min(start.missing_scans(), kMostMissingScans),
                            .is_exact = start.is_exact()};
}

/// Returns how many scans `take` may return: scans of the first raw run that the aux stream also has.
std::size_t ScanMerger::ready_scans() const noexcept {
  if (raw_.runs.empty()) return 0;
  std::size_t ready = raw_.runs.front().left;
  if (!is_finished_) {
    const std::uint64_t allowed = raw_.waiting_scans > lag_scans_ ? raw_.waiting_scans - lag_scans_ : 0;
    ready = static_cast<std::size_t>(std::min<std::uint64_t>(ready, allowed));
  }
  if (!device_.aux_stream) return ready;
  if (aux_.runs.empty() || aux_.runs.front().next() != raw_.runs.front().next()) return 0;  // the aux scans have not been added yet
  return std::min(ready, aux_.runs.front().left);
}

bool ScanMerger::is_gap_ahead(const Run& run) const noexcept { return expected_ && run.next() != *expected_; }

core::Gap ScanMerger::gap_before(const Run& run) const {
  const Place next = run.next();
  if (next.segment == expected_->segment) {  // the device delivered these scans, but the recorder was too slow
    return {
        .reason = core::GapReason::RingFull, .missing_scans = std::min(next.scan - expected_->scan, kMostMissingScans), .is_exact = true};
  }
  if (const auto reported = gaps_.find(next.segment); reported != gaps_.end()) return reported->second;
  const double hole_scans = std::round((run.first_time_s - next_time_s_) * device_.rate.hz());
  const bool is_forward = hole_scans > 0.0 && hole_scans < 1e15;
  return {.reason = core::GapReason::Silence, .missing_scans = is_forward ? static_cast<std::uint64_t>(hole_scans) : 0, .is_exact = false};
}

void ScanMerger::apply_changes(Place at) {
  while (!changes_.empty() && changes_.front().at <= at) {
    bits_ = std::move(changes_.front().bits);
    changes_.pop_front();
  }
}

std::size_t ScanMerger::until_change(Place from, std::size_t scans) const noexcept {
  if (changes_.empty() || changes_.front().at.segment != from.segment) return scans;
  return static_cast<std::size_t>(std::min<std::uint64_t>(scans, changes_.front().at.scan - from.scan));
}

void ScanMerger::copy(Column& column, core::Block& block, std::size_t at, std::size_t scans) {
  Run& run = column.runs.front();
  const std::size_t width = column.channels.size();
  const double* values = run.values.data() + (run.count - run.left) * width;
  for (std::size_t c = 0; c < width; ++c) {
    const auto out = block.column(column.channels[c]).subspan(at, scans);
    for (std::size_t i = 0; i < scans; ++i) out[i] = values[i * width + c];
  }
  run.left -= scans;
  column.waiting_scans -= scans;
  if (run.left == 0) column.runs.pop_front();
}

void ScanMerger::set_bits(core::Block& block, std::size_t at, std::size_t scans) const {
  for (std::size_t c = 0; c < bits_.size(); ++c) std::ranges::fill(block.quality(c).subspan(at, scans), bits_[c]);
}

ScanMerger::Taken ScanMerger::take(core::Block& block, core::Gap& gap) {
  block.set_count(0);
  if (ready_scans() == 0) return Taken::Nothing;
  const Place first = raw_.runs.front().next();
  if (is_gap_ahead(raw_.runs.front())) {
    gap = gap_before(raw_.runs.front());
    gaps_.erase(gaps_.begin(), gaps_.upper_bound(first.segment));
    expected_.reset();
    return Taken::Gap;
  }
  fill(block);
  return Taken::Scans;
}

void ScanMerger::fill(core::Block& block) {
  const std::size_t room = block.capacity();
  Place at = raw_.runs.front().next();
  block.set_count(room);
  block.segment = at.segment;
  block.first_scan = {at.scan};
  std::size_t filled = 0;
  while (filled < room) {
    const std::size_t ready = ready_scans();
    if (ready == 0 || raw_.runs.front().next() != at) break;
    apply_changes(at);
    const std::size_t scans = until_change(at, std::min(ready, room - filled));
    const Run& run = raw_.runs.front();
    next_time_s_ = run.first_time_s + static_cast<double>(at.scan - run.first.scan + scans) / device_.rate.hz();
    set_bits(block, filled, scans);
    copy(raw_, block, filled, scans);
    if (device_.aux_stream) copy(aux_, block, filled, scans);
    filled += scans;
    at.scan += scans;
  }
  block.set_count(filled);
  expected_ = at;
}

}  // namespace dts::device::replay
