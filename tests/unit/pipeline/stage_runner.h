// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "pipeline/stage.h"

namespace dts::pipeline {

/// A whole recording of one stream, columns by channel; scan i has index `first_scan` + i.
struct Signal {
  core::StreamFormat format;
  std::vector<std::vector<double>> values;
  std::vector<std::vector<std::uint8_t>> bits;
  std::uint64_t first_scan = 0;

  [[nodiscard]] std::size_t scans() const { return values.empty() ? 0 : values.front().size(); }
};

/// The first scans of `signal`, and the rest of it.
inline Signal until(Signal signal, std::size_t scans) {
  for (auto& column : signal.values) column.resize(scans);
  for (auto& column : signal.bits) column.resize(scans);
  return signal;
}
inline Signal from(Signal signal, std::size_t first) {
  for (auto& column : signal.values) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  for (auto& column : signal.bits) column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first));
  signal.first_scan += first;
  return signal;
}

inline core::Rate rate_hz(double hz) { return core::Rate::from_hz(hz).value(); }

/// A signal without doubts.
inline Signal make_signal(double hz, const std::string& unit, std::vector<std::vector<double>> columns) {
  Signal signal{.format = {.name = "in", .rate = rate_hz(hz), .channels = {}}, .values = std::move(columns), .bits = {}};
  for (std::size_t c = 0; c < signal.values.size(); ++c) {
    signal.format.channels.push_back({.name = "c" + std::to_string(c), .unit = unit});
    signal.bits.emplace_back(signal.values[c].size());
  }
  return signal;
}

/// Host time that the runner gives to a scan.
inline std::int64_t host_time_ns(const core::Rate& rate, std::uint64_t scan) { return 5'000'000'000 + rate.time_ns(core::ScanIndex{scan}); }

/// What came out, scan by scan.
struct Output {
  std::vector<std::uint64_t> scan;
  std::vector<std::int64_t> block_host_time_ns;  ///< Of the first scan of its block, for each block that gave something ...
  std::vector<std::uint64_t> block_first_scan;   ///< ... and that scan.
  std::vector<std::vector<double>> values;
  std::vector<std::vector<std::uint8_t>> bits;
  std::vector<core::ReachEvent> reaches;  ///< Told ...
  std::vector<core::ClassEvent> classes;  ///< ... as well.
  std::vector<core::SwayEvent> sways;
  std::uint64_t lost_sways = 0;  ///< Found no room.
};

/// Scans [first, first + scans) of `signal` as one block.
inline void fill_block(const Signal& signal, std::size_t first, std::size_t scans, core::Block& block) {
  block.set_count(scans);
  block.first_scan = core::ScanIndex{signal.first_scan + first};
  block.host_time_ns = host_time_ns(signal.format.rate, signal.first_scan + first);
  for (std::size_t c = 0; c < block.channel_count(); ++c) {
    std::copy_n(signal.values[c].begin() + static_cast<std::ptrdiff_t>(first), scans, block.column(c).begin());
    std::copy_n(signal.bits[c].begin() + static_cast<std::ptrdiff_t>(first), scans, block.quality(c).begin());
  }
}

inline void append(Output& output, const core::Block& block) {
  if (block.count() == 0) return;
  output.block_host_time_ns.push_back(block.host_time_ns);
  output.block_first_scan.push_back(block.first_scan.value);
  output.values.resize(block.channel_count());
  output.bits.resize(block.channel_count());
  for (std::size_t i = 0; i < block.count(); ++i) output.scan.push_back(block.first_scan.value + i);
  for (std::size_t c = 0; c < block.channel_count(); ++c) {
    output.values[c].insert(output.values[c].end(), block.column(c).begin(), block.column(c).end());
    output.bits[c].insert(output.bits[c].end(), block.quality(c).begin(), block.quality(c).end());
  }
}

/// What a stage before this one could have told of these scans: a reach now and then.
inline core::FrameEvents events_before(const Signal& signal, std::size_t first, std::size_t scans) {
  constexpr std::uint64_t kEvery = 40;
  core::FrameEvents events;
  for (std::uint64_t scan = signal.first_scan + first; scan < signal.first_scan + first + scans; ++scan) {
    if (scan % kEvery != kEvery - 1) continue;
    const double part = static_cast<double>(scan % 700) / 1000.0;
    core::ReachEvent event{.step = core::ReachStep::Final, .number = static_cast<std::uint32_t>(scan / kEvery), .scan = {scan}};
    event.host_time_ns = host_time_ns(signal.format.rate, scan);
    event.features = {.p1_mm = 3.5,
                      .p2_mm = 3.2,
                      .p3_mm = 3.5 * (1.0 + part),
                      .hold_mm = 3.0 * part,
                      .rise_s = 0.8,
                      .rest_ratio = -0.2,
                      .ratio_change = part / 4.0,
                      .twist = 0.0,
                      .smoothness = -2.0};
    events.reaches.push(event);
  }
  return events;
}

/// Sends `signal` through a prepared stage in blocks of the given sizes, which repeat. The output block holds rubbish before
/// each call, as a used frame does.
inline Output run(Stage& stage, std::size_t output_channels, const Signal& signal, std::span<const std::size_t> block_sizes) {
  const std::size_t capacity = std::max<std::size_t>(1, std::ranges::max(block_sizes));
  core::Block in(signal.values.size(), capacity);
  core::Block out(output_channels, capacity);
  Output output;
  output.values.resize(output_channels);
  output.bits.resize(output_channels);
  std::size_t block = 0;
  for (std::size_t first = 0; first < signal.scans(); ++block) {
    const std::size_t scans = std::min(block_sizes[block % block_sizes.size()], signal.scans() - first);
    fill_block(signal, first, scans, in);
    out.copy_position(in);
    for (std::size_t c = 0; c < output_channels; ++c) {
      std::ranges::fill(out.column(c), 12345.0);
      std::ranges::fill(out.quality(c), std::uint8_t{0x80});
    }
    stage.process(in, out);
    append(output, out);
    core::FrameEvents events = events_before(signal, first, scans);
    const std::size_t given = events.reaches.count;
    stage.tell(events);
    for (const core::ReachEvent& event : events.reaches.all_of().subspan(given)) output.reaches.push_back(event);
    for (const core::ClassEvent& event : events.classes.all_of()) output.classes.push_back(event);
    for (const core::SwayEvent& event : events.sways.all_of()) output.sways.push_back(event);
    output.lost_sways += events.sways.lost;
    first += scans;
  }
  return output;
}

/// The same, prepared for the signal first.
inline Output prepare_and_run(Stage& stage, const Signal& signal, std::size_t block_size = 64) {
  const core::StreamFormat output_format = stage.prepare(signal.format, block_size).value();
  const std::size_t channels = stage.describe().output_stream.empty() ? 0 : output_format.channels.size();
  return run(stage, channels, signal, std::span(&block_size, 1));
}

}  // namespace dts::pipeline
