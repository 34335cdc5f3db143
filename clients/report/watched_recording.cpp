// SPDX-License-Identifier: Apache-2.0
#include "report/watched_recording.h"

#include <cmath>
#include <variant>

namespace dts::report {
namespace {

constexpr std::size_t kMostSegments = 100'000;
constexpr double kLongestNs = 1e17;  // three years

}  // namespace

core::Result<std::optional<record::RecordedItem>> WatchedRecording::next() {
  if (!wants_more_()) return core::fail(core::ErrorCode::Failed, "interrupted");
  auto item = recording_.next();
  if (!item || !*item) return item;
  if (const auto* timed = std::get_if<record::TimedEvent>(&**item); timed != nullptr && timed->event.has_segment_start())
    note(timed->event);
  return item;
}

void WatchedRecording::note(const v1::Event& event) {
  if (segments_.size() >= kMostSegments || !event.has_host_time_ns()) return;
  segments_[event.segment()] = {.scan = {event.scan()}, .host_time_ns = event.host_time_ns()};
}

std::optional<std::int64_t> WatchedRecording::host_time_ns(std::uint32_t segment, core::ScanIndex scan, double raw_rate_hz) const {
  const auto found = segments_.find(segment);
  if (found == segments_.end() || !(raw_rate_hz > 0.0)) return std::nullopt;
  const double scans = static_cast<double>(scan.value) - static_cast<double>(found->second.scan.value);
  const double later_ns = 1e9 * scans / raw_rate_hz;
  if (!(std::abs(later_ns) < kLongestNs) || std::abs(static_cast<double>(found->second.host_time_ns)) > 8e18) return std::nullopt;
  return found->second.host_time_ns + std::llround(later_ns);
}

}  // namespace dts::report
