// SPDX-License-Identifier: Apache-2.0
#include "accuracy/capture.h"

#include <algorithm>
#include <chrono>
#include <limits>

namespace dts::accuracy {
namespace {

using client::Block;
using client::ErrorCode;
using client::Result;

constexpr std::array<const char*, 3> kCopChannels = {"ml_mm", "ap_mm", "load_n"};
constexpr std::array<const char*, 3> kTruthChannels = {"true_ml_mm", "true_ap_mm", "true_load_n"};
constexpr std::chrono::seconds kPatience{100};  // beyond the duration of the data

Result<void> append(const Block& block, const std::array<const char*, 3>& wanted, Track& track) {
  track.rate_hz = block.rate.hz();
  track.delay_s = static_cast<double>(block.format->delay_ns) * 1e-9;
  const std::size_t first = block.first_scan;
  const std::size_t end = std::max(track.size(), first + block.scan_count);
  track.doubts.resize(end, 0);
  for (std::size_t c = 0; c < wanted.size(); ++c) {
    const auto found = std::ranges::find(block.format->channels, wanted[c], &client::ChannelFormat::name);
    if (found == block.format->channels.end()) {
      return client::fail(ErrorCode::DataDamaged, std::string(block.topic) + " has no channel " + wanted[c]);
    }
    const auto channel = static_cast<std::size_t>(found - block.format->channels.begin());
    track.columns[c].resize(end, std::numeric_limits<double>::quiet_NaN());
    std::ranges::copy(block.column(channel), track.columns[c].begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t i = 0; i < block.scan_count; ++i) track.doubts[first + i] |= block.quality[channel];
  }
  return {};
}

Result<void> take(const client::Message& message, Captures& captures) {
  if (std::holds_alternative<client::Restart>(message)) return client::fail(ErrorCode::DeviceGone, "the daemon was restarted");
  const auto* block = std::get_if<Block>(&message);
  if (block == nullptr) return {};
  const auto found = captures.find(block->rig);
  if (found == captures.end()) return {};
  if (block->segment != 0) return client::fail(ErrorCode::DeviceGone, std::string(block->topic) + ": a gap began a new segment");
  RigCapture& rig = found->second;
  rig.lost_on_the_way += block->lost_scans;
  rig.lost_before_pipeline = block->lost_before_pipeline_total;
  rig.dropped_blocks = block->dropped_blocks_total;
  if (block->stream == "cop") return append(*block, kCopChannels, rig.cop);
  return block->stream == "aux" ? append(*block, kTruthChannels, rig.truth) : Result<void>{};
}

bool reaches(const Track& track, double time_s) { return static_cast<double>(track.size()) > time_s * track.rate_hz && track.size() > 0; }

}  // namespace

std::vector<std::string> topics(const std::vector<Case>& cases) {
  std::vector<std::string> names;
  for (const Case& wanted : cases) {
    names.push_back(wanted.rig + "/cop");
    names.push_back(wanted.rig + "/aux");
  }
  return names;
}

Result<Captures> capture(client::Subscriber& subscriber, const std::vector<Case>& cases) {
  Captures captures;
  double longest_s = 0.0;
  for (const Case& wanted : cases) {
    captures[wanted.rig] = {};
    longest_s = std::max(longest_s, wanted.last_s);
  }
  const auto is_complete = [&] {
    return std::ranges::all_of(cases, [&](const Case& wanted) {
      const RigCapture& rig = captures[wanted.rig];
      return reaches(rig.cop, wanted.last_s) && reaches(rig.truth, wanted.last_s);
    });
  };
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(longest_s) + kPatience;
  while (std::chrono::steady_clock::now() < deadline) {
    const auto message = subscriber.receive(std::chrono::milliseconds(500));
    if (!message) return tl::make_unexpected(message.error());
    if (!message->has_value()) continue;
    if (auto taken = take(**message, captures); !taken) return tl::make_unexpected(taken.error());
    if (is_complete()) return captures;
  }
  return client::fail(ErrorCode::Timeout, "not all rigs delivered their data", "see the daemon's log");
}

}  // namespace dts::accuracy
