// SPDX-License-Identifier: Apache-2.0
// What one scan of sixteen sensors costs on its way through the stages of the chair, on one core, and what each stage adds. Input is
// synthetic: the simulated person of the shipped chair, who reaches every few seconds. CPU time; rounds are interleaved; the table shows
// medians.
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/clock.h"
#include "device/registry.h"
#include "files/rig_file.h"
#include "session/rig_pipeline.h"
#include "support/allocation_counter.h"

namespace dts {
namespace {

constexpr std::size_t kBlockScans = 30;  // 20 ms at 1500 Hz, as the rig's file says

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "reach_bench: %s\n", why.c_str());
  std::exit(EXIT_FAILURE);
}

/// Time this thread has had a core.
double cpu_time_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

pipeline::RigConfig chair() {
  files::Problems problems;
  pipeline::RigConfig config = files::read_rig_file(DTS_SOURCE_DIR "/config/rigs/chair-sim.toml", problems);
  if (!problems.empty()) give_up(files::to_string(problems.front()));
  config.name = "chair";
  config.block_scans = kBlockScans;
  return config;
}

/// Everything that the chair gives in `duration_s`, and whose channels they are.
struct Recorded {
  device::DeviceDescription description;
  std::vector<core::Acquired> blocks;
  std::uint64_t scans = 0;
};

Recorded simulate(const pipeline::RigConfig& config, double duration_s) {
  core::VirtualClock clock(1'000'000'000);
  auto device = device::create_device("sim:chair?seed=3&sit_down_s=1.5&truth=0", {.clock = clock, .rig = config.model});
  if (!device) give_up(core::to_string(device.error()));
  if (!(*device)->open() || !(*device)->start({.rate = config.rate, .max_block_scans = kBlockScans})) give_up("the device does not start");
  Recorded recorded{.description = (*device)->describe(), .blocks = {}};
  const auto wanted = static_cast<std::uint64_t>(duration_s * config.rate.hz());
  while (recorded.scans < wanted) {
    core::Acquired acquired{.block = core::Block(recorded.description.channels.size(), kBlockScans)};
    if ((*device)->read(acquired.block, std::int64_t{1} << 62U).outcome != device::ReadOutcome::Scans) give_up("the device gives nothing");
    recorded.scans += acquired.block.count();
    recorded.blocks.push_back(std::move(acquired));
  }
  return recorded;
}

struct Row {
  std::string name;
  std::size_t stages = 0;
  std::vector<double> ns_per_scan{};
  std::uint64_t heap_calls = 0;
  std::uint64_t reaches = 0;
};

/// One pass of a fresh pipeline of the first stages over all that was recorded.
void measure(const pipeline::RigConfig& whole, const Recorded& recorded, Row& row) {
  pipeline::RigConfig config = whole;
  config.stages.resize(row.stages);
  auto made = session::make_rig_pipeline(config, recorded.description);
  if (!made) give_up(core::to_string(made.error()));
  core::Frame frame = made->pipeline->make_frame();
  const std::uint64_t heap_before = test::heap_calls_of_this_thread();
  const double begun_s = cpu_time_s();
  row.reaches = 0;
  for (const core::Acquired& acquired : recorded.blocks) {
    made->pipeline->process(acquired, frame);
    for (const core::ReachEvent& reach : made->pipeline->events().reaches.all_of())
      row.reaches += reach.step == core::ReachStep::Final ? 1 : 0;
  }
  const double spent_s = cpu_time_s() - begun_s;
  row.heap_calls += test::heap_calls_of_this_thread() - heap_before;
  row.ns_per_scan.push_back(spent_s * 1e9 / static_cast<double>(recorded.scans));
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print(const std::vector<Row>& rows) {
  std::printf("| stages | ns per scan, median (best) | adds | million scans/s | reaches found | heap calls |\n|---|---|---|---|---|---|\n");
  double before_ns = 0.0;
  for (const Row& row : rows) {
    const double ns = median(row.ns_per_scan);
    std::printf("| %s | %.1f (%.1f) | %.1f | %.2f | %llu | %llu |\n", row.name.c_str(), ns, std::ranges::min(row.ns_per_scan),
                ns - before_ns, 1e3 / ns, static_cast<unsigned long long>(row.reaches), static_cast<unsigned long long>(row.heap_calls));
    before_ns = ns;
  }
}

}  // namespace
}  // namespace dts

int main(int argc, char** argv) {
  std::size_t repetitions = 15;
  double duration_s = 60.0;
  CLI::App app{"Cost of one scan of sixteen sensors through the stages of the chair, as a Markdown table"};
  app.add_option("--reps", repetitions, "rounds; the median counts")->check(CLI::Range(1, 10'000))->capture_default_str();
  app.add_option("--duration", duration_s, "seconds of the simulated person")->check(CLI::Range(1.0, 3600.0))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  using namespace dts;
  const pipeline::RigConfig config = chair();
  const Recorded recorded = simulate(config, duration_s);
  std::vector<Row> rows;
  for (std::size_t stages = 1; stages <= config.stages.size(); ++stages) {
    rows.push_back({.name = (stages == 1 ? "" : rows.back().name + ", ") + config.stages[stages - 1].id, .stages = stages});
  }
  for (std::size_t round = 0; round < repetitions; ++round) {
    for (std::size_t k = 0; k < rows.size(); ++k) measure(config, recorded, rows[(k + round) % rows.size()]);
  }
  std::printf("CPU time, %zu interleaved rounds of %.0f s at %.0f Hz, %zu sensors, blocks of %zu scans\n\n", repetitions, duration_s,
              config.rate.hz(), config.model.sensors.size(), kBlockScans);
  print(rows);
}
