// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <iomanip>
#include <memory>
#include <sstream>
#include <string>

#include "dts/wire/event_json.h"
#include "record/recording.h"

namespace dts::record {

/// The items of a recording, one a line: stream, segment:scan, time and values; of all kinds or of the named stream (or "offset") alone.
inline std::string items_text(Recording& recording, const std::string& only = "") {
  std::string all;
  while (true) {
    const auto item = recording.next();
    EXPECT_TRUE(item) << item.error().what;
    if (!item || !*item) return all;
    std::ostringstream text;
    text << std::setprecision(13);
    const auto put = [&](std::size_t stream, std::uint32_t segment, core::ScanIndex scan, double time_s,
                         const std::vector<double>& values) {
      text << short_name(recording.streams().at(stream).name) << ' ' << segment << ':' << scan.value << " @" << time_s;
      for (const double value : values) text << ' ' << value;
    };
    if (const auto* scans = std::get_if<RecordedScans>(&**item)) {
      put(scans->stream, scans->segment, scans->first_scan, scans->first_time_s, scans->values);
      EXPECT_EQ(scans->values.size(), scans->count * recording.streams().at(scans->stream).channels.size());
    }
    if (const auto* change = std::get_if<RecordedChange>(&**item)) {
      put(change->stream, change->segment, change->scan, change->time_s, change->values);
    }
    if (const auto* event = std::get_if<TimedEvent>(&**item)) text << "event @" << event->time_s << ' ' << wire::to_json(event->event);
    if (const auto* offset = std::get_if<RecordedOffset>(&**item)) {
      text << "offset @" << offset->time_s << ' ' << short_name(recording.streams().at(offset->stream).name) << ' ' << offset->offset_s;
    }
    if (only.empty() || text.str().starts_with(only + " ")) all += text.str() + "\n";
  }
}

}  // namespace dts::record
