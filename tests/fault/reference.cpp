// SPDX-License-Identifier: Apache-2.0
#include "fault/reference.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "core/clock.h"
#include "device/registry.h"

namespace dts::fault {
namespace {

bool is_same(std::span<const double> a, std::span<const double> b) noexcept {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0;
}

}  // namespace

Reference Reference::compute(const pipeline::RigConfig& rig, double seconds) {
  core::VirtualClock clock(1'000'000'000);
  auto device = device::create_device(rig.device_uri, {.clock = clock, .rig = rig.model}).value();
  if (!device->open()) throw std::runtime_error("the simulated device cannot be opened");
  const std::size_t block_scans = 64;
  const core::Rate rate = device->start({.rate = rig.rate, .max_block_scans = block_scans}).value();
  core::Block block(device->describe().channels.size(), block_scans);
  Reference reference;
  reference.channels_ = rig.sensor_channels.size();
  const std::size_t wanted = static_cast<std::size_t>(rate.scans_in_ms(seconds * 1e3)) * reference.channels_;
  reference.values_.reserve(wanted + block_scans * reference.channels_);
  while (reference.values_.size() < wanted) {
    const device::ReadResult result = device->read(block, clock.now_ns() + 1'000'000'000);
    if (result.outcome != device::ReadOutcome::Scans) throw std::runtime_error("the simulated device stopped");
    for (std::size_t scan = 0; scan < block.count(); ++scan) {
      for (const std::size_t channel : rig.sensor_channels) reference.values_.push_back(block.column(channel)[scan]);
    }
  }
  return reference;
}

std::size_t Reference::same_from(std::size_t start, std::span<const double> run) const noexcept {
  std::size_t scan = 0;
  for (; (scan + 1) * channels_ <= run.size() && start + scan < scans(); ++scan) {
    if (!is_same(row(start + scan), run.subspan(scan * channels_, channels_))) break;
  }
  return scan;
}

std::optional<std::size_t> Reference::find(std::span<const double> run, std::size_t from) const noexcept {
  for (std::size_t start = from; start < scans(); ++start) {
    if (same_from(start, run) * channels_ == run.size()) return start;
  }
  return std::nullopt;
}

std::string Reference::difference(const RecordedRaw& recorded) const {
  std::size_t next = 0;  // scan since the device's start
  for (const RecordedRaw::Run& run : recorded.runs) {
    if (recorded.channels != channels_) return "the recording has " + std::to_string(recorded.channels) + " channels";
    const std::string where = "segment " + std::to_string(run.segment) + " from scan " + std::to_string(run.first_scan);
    const std::size_t count = run.values.size() / channels_;
    // Indices of the first segment count from the device's start; where a later one begins, its scans show.
    const std::optional<std::size_t> start = run.segment == 0 ? std::optional(run.first_scan) : find(run.values, next);
    if (!start) return where + ": " + std::to_string(count) + " scans that are nowhere in what the simulator gives";
    if (*start < next || *start + count > scans()) return where + " overlaps, or goes beyond the reference";
    const std::size_t same = same_from(*start, run.values);
    if (same < count) return where + ": scan " + std::to_string(run.first_scan + same) + " differs from the simulator's";
    next = *start + count;
  }
  return {};
}

}  // namespace dts::fault
