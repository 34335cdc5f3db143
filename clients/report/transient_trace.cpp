// SPDX-License-Identifier: Apache-2.0
#include "report/transient_trace.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace dts::report {
namespace {

constexpr double kLongestTraceS = 60.0;
constexpr std::size_t kMostTraceSamples = 20'000'000;  // of all trials together
constexpr double kSmoothingS = 0.05;                   // as the stage `reach` smooths
constexpr double kUnknownMm = std::numeric_limits<double>::quiet_NaN();

/// The stream "transient" of a recording.
struct TransientColumn {
  std::size_t stream = 0;
  std::size_t width = 0;
  std::size_t place = 0;
  double rate_hz = 0.0;
  double raw_rate_hz = 0.0;

  [[nodiscard]] double sample_of(core::ScanIndex scan) const { return static_cast<double>(scan.value) * rate_hz / raw_rate_hz; }
};

std::optional<TransientColumn> find_transient(const record::Recording& recording) {
  const auto stream = recording.find_stream("transient");
  if (!stream || !recording.streams()[*stream].rate) return std::nullopt;
  const record::StreamInfo& info = recording.streams()[*stream];
  const auto column = std::ranges::find(info.channels, "transient_mm", &record::ChannelInfo::label);
  if (column == info.channels.end()) return std::nullopt;
  double raw_rate_hz = info.rate->hz();
  if (const auto raw = recording.find_stream("raw"); raw && recording.streams()[*raw].rate)
    raw_rate_hz = recording.streams()[*raw].rate->hz();
  return TransientColumn{.stream = *stream,
                         .width = info.channels.size(),
                         .place = static_cast<std::size_t>(column - info.channels.begin()),
                         .rate_hz = info.rate->hz(),
                         .raw_rate_hz = raw_rate_hz};
}

/// Prepares an empty trace with room for the samples of its window.
TransientTrace empty_trace(const TraceWindow& window, const TransientColumn& column, std::size_t& samples) {
  TransientTrace trace{.rate_hz = column.rate_hz};
  const double first = std::ceil(column.sample_of(window.begin));
  const double count = std::min(std::ceil(column.sample_of(window.end)) - first, kLongestTraceS * column.rate_hz);
  trace.begin_s = (first - column.sample_of(window.cue)) / column.rate_hz;
  if (!(count > 0.0) || !(column.rate_hz > 0.0)) {
    trace.problem = "the trial has no samples";
  } else if (samples + static_cast<std::size_t>(count) > kMostTraceSamples) {
    trace.problem = "the session has too many samples for one report";
  } else {
    samples += static_cast<std::size_t>(count);
    trace.mm.assign(static_cast<std::size_t>(count), kUnknownMm);
  }
  return trace;
}

void copy_samples(const record::RecordedScans& scans, const TransientColumn& column, const TraceWindow& window, TransientTrace& trace) {
  if (scans.segment != window.segment || trace.mm.empty()) return;
  const double first = std::ceil(column.sample_of(window.begin));
  for (std::size_t index = 0; index < scans.count; ++index) {
    const double place = static_cast<double>(scans.first_scan.value) + static_cast<double>(index) - first;
    if (place < 0.0 || place >= static_cast<double>(trace.mm.size())) continue;
    trace.mm[static_cast<std::size_t>(place)] = scans.values[index * column.width + column.place];
  }
}

}  // namespace

std::vector<double> TransientTrace::smoothed() const {
  std::vector<double> smooth(mm.size(), kUnknownMm);
  const auto half = static_cast<std::size_t>(std::max(0.0, std::floor(kSmoothingS * rate_hz / 2.0)));
  const std::size_t width = 2 * half + 1;
  double sum = 0.0;
  std::size_t known = 0;
  for (std::size_t index = 0; index < mm.size(); ++index) {
    if (std::isfinite(mm[index])) {
      sum += mm[index];
      ++known;
    }
    if (index >= width && std::isfinite(mm[index - width])) {
      sum -= mm[index - width];
      --known;
    }
    if (index + 1 >= width && known == width) smooth[index - half] = sum / static_cast<double>(width);
  }
  return smooth;
}

core::Result<std::vector<TransientTrace>> read_traces(record::Recording& recording, std::span<const TraceWindow> windows,
                                                      const std::function<void(double)>& progress) {
  if (windows.empty()) return std::vector<TransientTrace>{};
  const auto column = find_transient(recording);
  if (!column) {
    return core::fail(core::ErrorCode::NotFound, "the recording has no stream \"transient\": it is no session of a chair",
                      "choose a session of a floor platform or of a chair: dtsctl session list");
  }
  DTS_TRY(recording.rewind());
  std::size_t samples = 0;
  std::vector<TransientTrace> traces;
  for (const TraceWindow& window : windows) traces.push_back(empty_trace(window, *column, samples));
  while (true) {
    DTS_TRY_ASSIGN(const auto item, recording.next());
    if (!item) return traces;
    if (recording.size() > 0) progress(static_cast<double>(recording.offset()) / static_cast<double>(recording.size()));
    const auto* scans = std::get_if<record::RecordedScans>(&*item);
    if (scans == nullptr || scans->stream != column->stream) continue;
    for (std::size_t index = 0; index < windows.size(); ++index) copy_samples(*scans, *column, windows[index], traces[index]);
  }
}

}  // namespace dts::report
