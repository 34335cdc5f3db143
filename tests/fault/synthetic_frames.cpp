// SPDX-License-Identifier: Apache-2.0
#include "fault/synthetic_frames.h"

#include <stdexcept>

namespace dts::fault {
namespace {

constexpr std::size_t kCopChannels = 3;
constexpr std::int64_t kFlushNs = 150'000'000;
constexpr double kChunksPerS = 1.0 / 0.16;  // a flush every 0.15 s, seen when a block of 20 ms has come

record::StreamInfo stream(const std::string& name, record::ValueType type, const std::vector<core::ChannelFormat>& channels) {
  record::StreamInfo info{.name = "floor/" + name, .content = "DTS", .value_type = type, .channels = {}};
  info.rate = core::Rate::create(SyntheticFrames::kRateHz, 1).value();
  for (const core::ChannelFormat& channel : channels)
    info.channels.push_back({.label = channel.name, .unit = channel.unit, .type = "Misc"});
  return info;
}

void require(const core::Status& status) {
  if (!status) throw std::runtime_error(core::to_string(status.error()));
}

}  // namespace

SyntheticFrames::SyntheticFrames() : rate_(core::Rate::create(kRateHz, 1).value()) {
  frame_.streams.emplace_back(kSensors, kBlockScans);
  frame_.streams.emplace_back(kCopChannels, kBlockScans);
  for (core::Block& block : frame_.streams) block.set_count(kBlockScans);
}

/// A code of a 12-bit converter over 5 V, from the bits of a multiplication.
double SyntheticFrames::value(std::uint64_t scan, std::size_t channel) noexcept {
  const std::uint64_t mixed = (scan * kSensors + channel + 1) * 0x9E3779B97F4A7C15ULL;
  return static_cast<double>(mixed >> 52U) * (5.0 / 4096.0);
}

const core::Frame& SyntheticFrames::next() noexcept {
  for (core::Block& block : frame_.streams) {
    block.first_scan = {scan_};
    block.host_time_ns = now_ns();
    for (std::size_t channel = 0; channel < block.channel_count(); ++channel) {
      std::uint64_t scan = scan_;
      for (double& out : block.column(channel)) out = value(scan++, channel);
    }
  }
  frame_.host_time_ns = now_ns();
  scan_ += kBlockScans;
  return frame_;
}

std::vector<record::RecordedStream> SyntheticFrames::streams() {
  std::vector<core::ChannelFormat> sensors;
  for (std::size_t sensor = 1; sensor <= kSensors; ++sensor) sensors.push_back({.name = "w" + std::to_string(sensor) + "_v", .unit = "V"});
  std::vector<record::RecordedStream> streams;
  streams.push_back({.frame_index = 0, .info = stream("raw", record::ValueType::Double64, sensors)});
  streams.push_back(
      {.frame_index = 1, .info = stream("cop", record::ValueType::Float32, {{"ml_mm", "mm"}, {"ap_mm", "mm"}, {"load_n", "N"}})});
  return streams;
}

record::SessionFacts SyntheticFrames::facts() {
  record::SessionFacts facts;
  facts.session_id = "20261121T000000Z-floor-1";
  facts.rig = "floor";
  facts.kind = "floor";
  facts.protocol = "free";
  facts.software = "synthetic";
  return facts;
}

VirtualRecording::VirtualRecording(const std::string& file, double synchronise_s)
    : synchronise_ns_(static_cast<std::int64_t>(synchronise_s * 1e9)), flushed_ns_(frames_.now_ns()), synchronised_ns_(frames_.now_ns()) {
  auto recorder = record::Recorder::create(file, SyntheticFrames::facts(), SyntheticFrames::streams());
  if (!recorder) throw std::runtime_error(core::to_string(recorder.error()));
  recorder_ = std::move(*recorder);
}

void VirtualRecording::record(double seconds) {
  const std::int64_t until_ns = frames_.now_ns() + static_cast<std::int64_t>(seconds * 1e9);
  while (frames_.now_ns() < until_ns) {
    require(recorder_->take(frames_.next(), {}));
    const std::int64_t now_ns = frames_.now_ns();
    if (now_ns - flushed_ns_ >= kFlushNs) {
      flushed_ns_ = now_ns;
      require(recorder_->flush());
    }
    if (synchronise_ns_ > 0 && now_ns - synchronised_ns_ >= synchronise_ns_) {
      synchronised_ns_ = now_ns;
      require(recorder_->synchronise());
    }
  }
}

record::XdfWriter::Closed VirtualRecording::close() {
  require(recorder_->flush());
  auto closed = recorder_->close("");
  if (!closed) throw std::runtime_error(core::to_string(closed.error()));
  return *closed;
}

ExpectedSize expected_size(std::uint64_t scans) {
  constexpr double kRawBytes = 8.0 * SyntheticFrames::kSensors;
  constexpr double kCopBytes = 4.0 * kCopChannels;
  constexpr double kChunkBytes = 5.0 + 2.0 + 4.0 + 5.0 + 8.0;
  const auto count = static_cast<double>(scans);
  const double chunks = 2.0 * kChunksPerS * count / static_cast<double>(SyntheticFrames::kRateHz);
  const double data_bytes = count * (kRawBytes + kCopBytes);
  return {.data_bytes = data_bytes, .bytes = data_bytes + 2.0 * count + chunks * kChunkBytes, .index_bytes = chunks * 56.0};
}

}  // namespace dts::fault
