// SPDX-License-Identifier: Apache-2.0
// How fast a recording goes through a rig's pipeline again: sixteen channels on one core, without a disk. Scans of a synthetic
// recording are merged out of its streams (the replay device's ScanMerger), processed by the stages of a floor rig with sixteen sensors,
// and handed on as frames. CPU time; the table shows the median of the rounds.
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "device/replay/scan_merger.h"
#include "files/rig_file.h"
#include "session/rig_pipeline.h"

namespace dts {
namespace {

constexpr std::size_t kChunkScans = 300;  // 0.2 s at 1500 Hz, as the recorder writes
constexpr std::size_t kBlockScans = 256;
constexpr double kGoalScansPerSecond = 1e6;

/// Time this thread has had a core.
double cpu_time_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// The device of a rig whose channels are its sensors.
device::replay::RecordedDevice describe(const pipeline::RigConfig& rig) {
  device::replay::RecordedDevice device;
  for (std::size_t channel = 0; channel < rig.model.sensors.size(); ++channel) {
    device.description.channels.push_back({.name = "ch" + std::to_string(channel), .unit = "V", .minimum = -10.0, .maximum = 10.0});
    device.raw_channels.push_back(channel);
  }
  device.description.uri = "bench";
  device.rate = rig.rate;
  return device;
}

/// Volts between an empty plate and somebody on it, with noise.
std::vector<record::RecordedItem> make_chunks(std::size_t channels, std::size_t scans) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> volts(0.95, 1.35);
  std::vector<record::RecordedItem> chunks;
  for (std::size_t first = 0; first < scans; first += kChunkScans) {
    record::RecordedScans chunk{.first_scan = {first}, .count = kChunkScans, .values = std::vector<double>(kChunkScans * channels)};
    for (double& value : chunk.values) value = volts(random);
    chunks.emplace_back(std::move(chunk));
  }
  return chunks;
}

/// Seconds for one round with or without the stages; every round begins anew.
double round_s(const pipeline::RigConfig& rig, const std::vector<record::RecordedItem>& chunks, bool has_stages) {
  const auto device = describe(rig);
  auto made = session::make_rig_pipeline(rig, device.description).value();
  device::replay::ScanMerger merger(device);
  core::Acquired acquired{.block = core::Block(device.description.channels.size(), kBlockScans)};
  core::Frame frame = made.pipeline->make_frame();
  const double begun_s = cpu_time_s();
  const auto drain = [&] {
    while (merger.take(acquired.block, acquired.gap_before) == device::replay::ScanMerger::Taken::Scans) {
      if (has_stages) made.pipeline->process(acquired, frame);
    }
  };
  for (const record::RecordedItem& chunk : chunks) {
    (void)merger.add(chunk);
    drain();
  }
  merger.finish();
  drain();
  return cpu_time_s() - begun_s;
}

double median_s(const pipeline::RigConfig& rig, const std::vector<record::RecordedItem>& chunks, bool has_stages, int rounds) {
  std::vector<double> all;
  for (int round = 0; round < rounds; ++round) all.push_back(round_s(rig, chunks, has_stages));
  std::ranges::sort(all);
  return all[all.size() / 2];
}

int run(const std::string& rig_file, std::size_t scans, int rounds) {
  files::Problems problems;
  pipeline::RigConfig rig = files::read_rig_file(rig_file, problems);
  if (!problems.empty()) {
    std::fprintf(stderr, "replay_bench: %s\n", files::to_string(problems.front()).c_str());
    return EXIT_FAILURE;
  }
  rig.name = "bench";
  rig.block_scans = kBlockScans;
  const auto chunks = make_chunks(rig.model.sensors.size(), scans);
  const auto total = static_cast<double>(chunks.size() * kChunkScans);
  std::printf("| %zu channels, blocks of %zu | ns per scan | million scans/s |\n|---|---|---|\n", rig.model.sensors.size(), kBlockScans);
  double per_second = 0.0;
  for (const bool has_stages : {false, true}) {
    const double seconds = median_s(rig, chunks, has_stages, rounds);
    per_second = total / seconds;
    std::printf("| %s | %.0f | %.2f |\n", has_stages ? "and through the stages" : "merged out of the recording", 1e9 * seconds / total,
                1e-6 * per_second);
  }
  std::printf("\ngoal: %.0f million scans/s: %s\n", 1e-6 * kGoalScansPerSecond, per_second >= kGoalScansPerSecond ? "met" : "missed");
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace dts

int main(int argc, char** argv) {
  CLI::App app("Scans per second of a replay through a rig's stages, without a disk");
  std::string rig = "config/rigs/floor16-sim.toml";
  std::size_t scans = 300'000;
  int rounds = 5;
  app.add_option("--rig", rig, "Rig file");
  app.add_option("--scans", scans, "Scans per round");
  app.add_option("--rounds", rounds, "Rounds; the median counts")->check(CLI::Range(1, 1000));
  CLI11_PARSE(app, argc, argv);
  return dts::run(rig, scans, rounds);
}
