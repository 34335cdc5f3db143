// SPDX-License-Identifier: Apache-2.0
// A fake board at a pseudo-terminal, in real time: the reader's CPU time, and the latency from the end of a block to its delivery.
#include <time.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>

#include "bench/percentiles.h"
#include "board/fd_board.h"
#include "device/registry.h"
#include "physics/rig_model.h"

namespace dts::bench {
namespace {

constexpr std::size_t kChannels = 16;
constexpr double kRateHz = 1500.0;
constexpr std::size_t kBlockScans = 30;  // 20 ms

double thread_cpu_s() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) * 1e-9;
}

int fail(const std::string& what) {
  std::fprintf(stderr, "board_bench: %s\n", what.c_str());
  return 1;
}

int measure(const char* name, test::FakeBoardSetup setup, const std::string& options, double seconds) {
  core::SystemClock clock;
  const physics::RigModel plate;
  test::PtyBoard board(std::move(setup));
  const auto device = device::create_device("serial:" + board.path() + "?" + options, {clock, plate});
  if (!device) return fail(core::to_string(device.error()));
  if (const auto opened = (*device)->open(); !opened) return fail(core::to_string(opened.error()));
  const auto rate = (*device)->start({core::Rate::from_hz(kRateHz).value(), kBlockScans});
  if (!rate) return fail(core::to_string(rate.error()));
  core::Block block(kChannels, kBlockScans);
  Percentiles latency(static_cast<std::size_t>(seconds * kRateHz));
  const std::int64_t begin_ns = clock.now_ns();
  const double begin_cpu_s = thread_cpu_s();
  std::uint64_t gaps = 0;
  while (clock.now_ns() < begin_ns + static_cast<std::int64_t>(seconds * 1e9)) {
    const device::ReadResult result = (*device)->read(block, clock.now_ns() + core::kNanosecondsPerSecond);
    if (result.outcome != device::ReadOutcome::Scans) {
      ++gaps;
      continue;
    }
    latency.add_ns(clock.now_ns() - block.host_time_ns - rate->time_ns({block.count() - 1}));
  }
  const double cpu_percent = 100.0 * (thread_cpu_s() - begin_cpu_s) / seconds;
  latency.sort();
  std::printf("| %s | %.2f | %.2f | %.2f | %llu |\n", name, cpu_percent, latency.us(0.5) * 1e-3, latency.us(0.99) * 1e-3,
              static_cast<unsigned long long>(gaps));
  return 0;
}

}  // namespace
}  // namespace dts::bench

int main(int argc, char** argv) {
  CLI::App app("A board at a pseudo-terminal, 16 channels at 1500 Hz, blocks of 30 scans.");
  double seconds = 20.0;
  app.add_option("--seconds", seconds, "How long each row takes");
  CLI11_PARSE(app, argc, argv);
  std::printf("| format | CPU of the reader, %% of a core | latency p50, ms | p99, ms | gaps |\n|---|---|---|---|---|\n");
  using dts::bench::kChannels;
  using dts::bench::measure;
  const int frames = measure("frames, 7 scans each", {.channels = kChannels, .scans_per_frame = 7}, "channels=16", seconds);
  const int lines = measure("lines, counted", {.speaks_lines = true, .channels = kChannels, .rate = {1500, 1}, .has_counter = true},
                            "channels=16&format=lines&rate_hz=1500&counter=1", seconds);
  return frames + lines;
}
