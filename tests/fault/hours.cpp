// SPDX-License-Identifier: Apache-2.0
#include "fault/hours.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "fault/synthetic_frames.h"
#include "record/recording.h"
#include "record/xdf/chunk_index.h"
#include "record/xdf/recovery.h"
#include "system/daemon_process.h"

namespace dts::fault {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Every scan is there, in order, with the value it was given; looked at one in a thousand.
std::string check_scans(const std::string& file, std::uint64_t expected) {
  auto recording = record::Recording::open(file);
  if (!recording) return core::to_string(recording.error());
  const auto raw = (*recording)->find_stream("raw");
  std::uint64_t next = 0;
  while (true) {
    auto item = (*recording)->next();
    if (!item) return core::to_string(item.error());
    if (!*item) break;
    const auto* scans = std::get_if<record::RecordedScans>(&**item);
    if (scans == nullptr || scans->stream != raw) continue;
    if (scans->first_scan.value != next) return "scan " + std::to_string(next) + " is missing";
    for (std::size_t scan = 0; scan < scans->count; scan += 1000) {
      const std::size_t channel = scan / 1000 % SyntheticFrames::kSensors;
      if (scans->values[scan * SyntheticFrames::kSensors + channel] != SyntheticFrames::value(next + scan, channel)) {
        return "scan " + std::to_string(next + scan) + " has another value";
      }
    }
    next += scans->count;
  }
  return next == expected ? "" : "there are " + std::to_string(next) + " scans";
}

}  // namespace

LongRecording record_hours(double hours, const std::string& folder) {
  constexpr double kSynchroniseS = 10.0;
  constexpr double kWarmUpS = 60.0;
  const std::string file = folder + "/long.xdf";
  LongRecording result{.hours = hours};
  const auto start = Clock::now();
  VirtualRecording recording(file, kSynchroniseS);
  recording.record(kWarmUpS);
  result.resident_start_kb = test::resident_kb(::getpid());
  recording.record(hours * 3600.0 - kWarmUpS);
  result.resident_end_kb = test::resident_kb(::getpid());
  const auto closed = recording.close();
  result.took_s = seconds_since(start);
  result.scans = recording.scans();
  result.bytes = closed.bytes;
  result.index_bytes = std::filesystem::file_size(record::index_name(file));
  const ExpectedSize expected = expected_size(result.scans);
  result.data_bytes = expected.data_bytes;
  result.expected_bytes = expected.bytes;
  const auto verify_start = Clock::now();
  const auto verified = record::verify(file);
  result.verify_s = seconds_since(verify_start);
  if (!verified) {
    result.problem = core::to_string(verified.error());
  } else if (!verified->is_closed || !verified->has_index || verified->sha256 != closed.sha256 || verified->scans != result.scans) {
    result.problem = "the file is not what was written";
  } else {
    result.problem = check_scans(file, result.scans);
  }
  return result;
}

}  // namespace dts::fault
