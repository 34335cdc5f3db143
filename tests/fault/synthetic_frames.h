// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/frame.h"
#include "record/recorder.h"

namespace dts::fault {

/// Frames of a rig "floor" with 16 sensors and the centre of pressure at 1500 Hz, in blocks of 20 ms: synthetic, cheap, and the same for
/// the same scan. The host time of a scan is its index: hours pass as fast as they are asked for.
class SyntheticFrames {
 public:
  static constexpr std::size_t kSensors = 16;
  static constexpr std::size_t kBlockScans = 30;
  static constexpr std::int64_t kRateHz = 1500;
  static constexpr std::int64_t kOriginNs = 1'000'000'000'000;

  SyntheticFrames();

  /// The next 20 ms; valid until the next call.
  const core::Frame& next() noexcept;
  [[nodiscard]] std::int64_t now_ns() const noexcept { return kOriginNs + rate_.time_ns(core::ScanIndex{scan_}); }
  [[nodiscard]] std::uint64_t scans() const noexcept { return scan_; }
  [[nodiscard]] static double value(std::uint64_t scan, std::size_t channel) noexcept;

  [[nodiscard]] static std::vector<record::RecordedStream> streams();
  [[nodiscard]] static record::SessionFacts facts();

 private:
  core::Rate rate_;
  core::Frame frame_;
  std::uint64_t scan_ = 0;
};

/// Feeds a recorder as the record thread does it in virtual time: frames, a flush every 0.15 s. Synchronises every `synchronise_s` of
/// virtual time (0: never).
class VirtualRecording {
 public:
  VirtualRecording(const std::string& file, double synchronise_s);

  /// Throws when the recorder fails.
  void record(double seconds);
  [[nodiscard]] record::XdfWriter::Closed close();
  [[nodiscard]] std::uint64_t scans() const noexcept { return frames_.scans(); }

 private:
  SyntheticFrames frames_;
  std::unique_ptr<record::Recorder> recorder_;
  std::int64_t synchronise_ns_;
  std::int64_t flushed_ns_;
  std::int64_t synchronised_ns_;
};

/// What a recording of so many scans must come to, bytes:
///     streams: 1 per scan (there is no time stamp) + 8 or 4 per channel and scan
///     chunks:  length 5, tag 2, stream 4, count 5, time stamp 8
/// of "raw" (16 doubles) and "cop" (3 floats), plus headers, events, boundaries and clock offsets, which are small.
struct ExpectedSize {
  double data_bytes = 0.0;   ///< The values alone.
  double bytes = 0.0;        ///< With what XDF puts around them.
  double index_bytes = 0.0;  ///< About 56 a chunk, in the file beside it.
};
[[nodiscard]] ExpectedSize expected_size(std::uint64_t scans);

}  // namespace dts::fault
