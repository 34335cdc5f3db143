// SPDX-License-Identifier: Apache-2.0
#include "fault/recorded_raw.h"

#include <xdf.h>

#include <cmath>
#include <iostream>
#include <mutex>
#include <sstream>

#include "record/recording.h"

namespace dts::fault {
namespace {

void add_scans(const record::RecordedScans& scans, std::size_t channels, double period_s, RecordedRaw& raw) {
  if (scans.count == 0) return;
  const auto first = static_cast<std::size_t>(scans.first_scan.value);
  RecordedRaw::Run* last = raw.runs.empty() ? nullptr : &raw.runs.back();
  const bool continues = last != nullptr && last->segment == scans.segment && last->first_scan + last->values.size() / channels == first;
  if (!continues) last = &raw.runs.emplace_back(RecordedRaw::Run{.segment = scans.segment, .first_scan = first});
  last->values.insert(last->values.end(), scans.values.begin(), scans.values.end());
  if (raw.scans == 0) raw.first_time_s = scans.first_time_s;
  raw.scans += scans.count;
  raw.last_time_s = scans.first_time_s + static_cast<double>(scans.count - 1) * period_s;
}

#if !defined(__SANITIZE_ADDRESS__)
/// libxdf talks to std::cout, which is one for all threads.
int load(Xdf& xdf, const std::string& file) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::ostringstream sink;
  std::streambuf* const before = std::cout.rdbuf(sink.rdbuf());
  const int result = xdf.load_xdf(file);
  std::cout.rdbuf(before);
  return result;
}
#endif

}  // namespace

core::Result<RecordedRaw> read_raw(const std::string& file) {
  auto recording = record::Recording::open(file);
  if (!recording) return tl::make_unexpected(recording.error());
  if (!(*recording)->session()) return core::fail(core::ErrorCode::DataDamaged, file + " does not know its session");
  RecordedRaw raw{.damage = (*recording)->damage(), .facts = *(*recording)->session()};
  const auto index = (*recording)->find_stream("raw");
  while (true) {
    auto item = (*recording)->next();
    if (!item) return tl::make_unexpected(item.error());
    if (!*item) return raw;
    if (const auto* event = std::get_if<record::TimedEvent>(&**item)) raw.losses += event->event.has_loss() ? 1U : 0U;
    const auto* scans = std::get_if<record::RecordedScans>(&**item);
    if (scans == nullptr || !index || scans->stream != *index) continue;
    const record::StreamInfo& info = (*recording)->streams()[*index];
    raw.channels = info.channels.size();
    add_scans(*scans, raw.channels, 1.0 / info.rate->hz(), raw);
  }
}

std::string check_with_libxdf(const std::string& file, const RecordedRaw& ours) {
#if defined(__SANITIZE_ADDRESS__)
  static_cast<void>(file);
  static_cast<void>(ours);
  return {};
#else
  Xdf xdf;
  if (load(xdf, file) != 0) return "libxdf cannot open " + file;
  for (const Xdf::Stream& stream : xdf.streams) {
    if (!stream.info.name.ends_with("/raw")) continue;
    if (stream.time_stamps.size() != ours.scans) return "libxdf sees " + std::to_string(stream.time_stamps.size()) + " scans in " + file;
    const double apart_s = std::abs(stream.time_stamps.back() - ours.last_time_s);
    if (apart_s > 1e-3) return "libxdf sees the last scan " + std::to_string(apart_s) + " s from where we do in " + file;
    const std::vector<double>& values = ours.runs.back().values;
    for (std::size_t channel = 0; channel < ours.channels; ++channel) {  // it keeps floats
      const auto expected = static_cast<float>(values[values.size() - ours.channels + channel]);
      if (stream.time_series[channel].back() != expected) return "libxdf sees another last scan in " + file;
    }
    return {};
  }
  return ours.scans == 0 ? "" : "libxdf finds no raw stream in " + file;
#endif
}

}  // namespace dts::fault
