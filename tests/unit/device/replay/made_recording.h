// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "core/frame.h"
#include "record/recorder.h"

namespace dts::device::test {

/// What stands before the scans of a segment.
struct MadeSegment {
  std::size_t scans = 1000;
  core::Gap gap{};
};

/// A recording to be made: `sensors` columns in the raw stream, on the last channels of the device, the others in aux.
struct MadeRecording {
  std::size_t sensors = 2;
  std::size_t aux = 1;
  double rate_hz = 100.0;
  std::vector<MadeSegment> segments{{}};
  std::uint64_t first_scan = 0;  ///< Of the first segment: a recording begins in the middle of a stream.
  std::uint64_t lost_at = 0;     ///< Scan of the first segment from which ten never reach the recorder; 0: none.
  std::vector<std::string> stages{};
  std::vector<double> state{};
  bool has_device_channels = true;
  bool is_closed = true;

  [[nodiscard]] std::size_t channels() const { return sensors + aux; }
  /// Device channel of a column of the frame's raw, then aux streams.
  [[nodiscard]] std::size_t channel_of(std::size_t column) const { return column < sensors ? aux + column : column - sensors; }
};

/// Value of a device channel at the n-th scan of the stream, missing ones counted. Synthetic; some never had a value.
inline double made_value(std::size_t channel, std::uint64_t n) {
  if (n % 101 == 50 && channel == 0) return std::nan("");
  return 0.2 * static_cast<double>(channel + 1) + 0.05 * std::sin(0.013 * static_cast<double>(n) + static_cast<double>(channel));
}
inline std::uint8_t made_bits(std::size_t channel, std::uint64_t n) {
  if (n % 101 == 50 && channel == 0) return core::quality::kOutOfRange;
  return n % 37 < 2 + channel ? core::quality::kRail : std::uint8_t{0};
}

inline std::vector<record::RecordedStream> made_streams(const MadeRecording& made, core::Rate rate) {
  std::vector<record::RecordedStream> streams;
  for (const bool is_raw : {true, false}) {
    if (!is_raw && made.aux == 0) continue;
    record::StreamInfo info{.name = is_raw ? "floor/raw" : "floor/aux", .content = "DTS", .rate = rate};
    for (std::size_t c = 0; c < (is_raw ? made.sensors : made.aux); ++c) {
      info.channels.push_back(
          {.label = (is_raw ? "w" : "extra") + std::to_string(c + 1),
           .unit = "V",
           .type = "Voltage",
           .device_channel = made.has_device_channels ? static_cast<int>(made.channel_of(is_raw ? c : made.sensors + c)) : -1,
           .minimum = -5.0,
           .maximum = 5.0,
           .resolution = 10.0 / 2048.0,
           .is_sensor = true});
    }
    streams.push_back({.frame_index = streams.size(), .info = std::move(info)});
  }
  return streams;
}

inline void fill(core::Block& block, const MadeRecording& made, std::size_t first_column, std::uint64_t n) {
  for (std::size_t c = 0; c < block.channel_count(); ++c) {
    for (std::size_t i = 0; i < block.count(); ++i) {
      block.column(c)[i] = made_value(made.channel_of(first_column + c), n + i);
      block.quality(c)[i] = made_bits(made.channel_of(first_column + c), n + i);
    }
  }
}

/// Writes it with the recorder that the daemon uses; the name of the file.
inline std::string make_recording(const MadeRecording& made, const std::string& file) {
  constexpr std::size_t kBlock = 10;
  const core::Rate rate = core::Rate::from_hz(made.rate_hz).value();
  record::SessionFacts facts{.session_id = "20260101T000000Z-floor-1", .rig = "floor", .kind = "floor", .protocol = "free"};
  facts.boot_id = "test";
  facts.device_model = "Made device";
  facts.device_serial = "made-7";
  facts.stages = made.stages;
  auto recorder = record::Recorder::create(file, facts, made_streams(made, rate));
  EXPECT_TRUE(recorder) << (recorder ? "" : core::to_string(recorder.error()));
  if (!made.state.empty()) (*recorder)->set_stage_state(made.state);
  core::Frame frame;
  frame.streams.emplace_back(made.sensors, kBlock);
  if (made.aux > 0) frame.streams.emplace_back(made.aux, kBlock);
  std::uint64_t n = made.first_scan;
  for (std::uint32_t segment = 0; segment < made.segments.size(); ++segment) {
    const MadeSegment& now = made.segments[segment];
    n += now.gap.missing_scans;
    const std::uint64_t begin = segment == 0 ? made.first_scan : 0;
    for (std::uint64_t scan = begin; scan < begin + now.scans; scan += kBlock) {
      frame.gap_before = scan == begin ? now.gap : core::Gap{};
      frame.segment = segment;
      for (std::size_t s = 0; s < frame.streams.size(); ++s) {
        core::Block& block = frame.streams[s];
        block.segment = segment;
        block.first_scan = {scan};
        block.host_time_ns = 5'000'000'000 + rate.time_ns({n});
        block.set_count(std::min<std::size_t>(kBlock, begin + now.scans - scan));
        fill(block, made, s == 0 ? 0 : made.sensors, n);
      }
      n += frame.streams.front().count();
      if (segment == 0 && made.lost_at > 0 && scan == made.lost_at) continue;
      EXPECT_TRUE((*recorder)->take(frame, {}));
    }
  }
  EXPECT_TRUE((*recorder)->flush());
  if (!made.is_closed) return file + ".part";  // as a crash leaves it
  const auto closed = (*recorder)->close("");
  EXPECT_TRUE(closed) << (closed ? "" : core::to_string(closed.error()));
  return file;
}

/// A folder of its own for each test.
class WithFolder : public testing::Test {
 protected:
  WithFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "dts-replay-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~WithFolder() override { std::filesystem::remove_all(folder_); }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::filesystem::path folder_;
};

}  // namespace dts::device::test
