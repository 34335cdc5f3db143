// SPDX-License-Identifier: Apache-2.0
// What one scan of four sensors costs on its way through the floor pipeline, on one core, beside two baselines in the same
// run: a plain copy of the block, and the same arithmetic in one loop written by hand for this rig. Input is synthetic: a
// swaying person with sensor noise. CPU time; rounds are interleaved; the table shows medians.
#include <time.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/fault.h"
#include "pipeline/pipeline.h"
#include "support/allocation_counter.h"
#include "unit/pipeline/standing_signal.h"

namespace dts::pipeline {
namespace {

constexpr std::size_t kSignalScans = 4096;
constexpr std::size_t kSensors = 4;
constexpr std::array<std::size_t, 4> kBlockSizes{1, 2, 8, 64};
constexpr double kGoalScansPerSecond = 5e6;

void require(bool is_true, const char* claim) {
  if (is_true) return;
  std::fprintf(stderr, "pipeline_bench: %s\n", claim);
  std::exit(EXIT_FAILURE);
}

/// Time this thread has had a core: what others do on the machine counts only through its caches.
std::int64_t cpu_time_ns() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Takes a block of the device and gives the block made of it.
using Step = std::function<const core::Block&(const core::Acquired&)>;

struct Contender {
  std::string name;
  Step step;
  std::uint64_t next_scan = 0;
  std::vector<double> ns_per_scan{};  ///< One per round.
  std::uint64_t heap_calls = 0;       ///< Allocations and releases in all rounds.
};

/// Guard, window 3, linearise and cop in one loop: no columns in between, no streams, no options, no segments.
class FusedLoop {
 public:
  FusedLoop(const physics::RigModel& rig, physics::CopMethod method, std::size_t block_scans)
      : rig_(rig), estimator_(physics::CopEstimator::from_model(method, rig).value()), out_(3, block_scans) {}

  const core::Block& process(const core::Block& in) noexcept {
    out_.copy_position(in);
    for (std::size_t i = 0; i < in.count(); ++i) {
      std::array<double, kSensors> deflection_mm{};
      std::uint8_t bits = 0;
      for (std::size_t c = 0; c < kSensors; ++c) {
        deflection_mm[c] = sensor_mm(c, in.column(c)[i], bits);
      }
      const bool is_fault = (bits & kFaultBits) != 0;
      const physics::CopEstimate cop = estimator_.estimate(deflection_mm);
      if (!cop.is_inside_calibration()) bits |= core::quality::kUncalibrated;
      write(i, 0, is_fault ? kNaN : cop.x_mm - 215.0, bits);
      write(i, 1, is_fault ? kNaN : cop.y_mm - 215.0, bits);
      write(i, 2, is_fault ? kNaN : cop.load_n, bits);
    }
    return out_;
  }

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  struct Sensor {
    std::array<double, 2> before_v{};  ///< The two scans before.
    std::array<std::uint8_t, 2> before_bits{};
    std::uint64_t repeats = 0;
  };

  double sensor_mm(std::size_t channel, double volts, std::uint8_t& scan_bits) noexcept {
    Sensor& sensor = sensors_[channel];
    sensor.repeats = volts == sensor.before_v[1] ? sensor.repeats + 1 : 0;
    std::uint8_t bits = std::abs(volts) >= 4.99 ? core::quality::kRail : 0;
    if (sensor.repeats > 100) bits |= core::quality::kStuck;
    if (!std::isfinite(volts)) bits |= core::quality::kOutOfRange;
    const core::Volts mean{(sensor.before_v[0] + sensor.before_v[1] + volts) / 3.0};
    scan_bits |= static_cast<std::uint8_t>(bits | sensor.before_bits[0] | sensor.before_bits[1]);
    sensor.before_v = {sensor.before_v[1], volts};
    sensor.before_bits = {sensor.before_bits[1], bits};
    const physics::SensorModel& model = rig_.sensors[channel];
    if (!model.curve.contains(mean)) scan_bits |= core::quality::kOutOfRange;
    return (model.unloaded_gap - model.curve.gap(mean)).value;
  }
  void write(std::size_t scan, std::size_t channel, double value, std::uint8_t bits) noexcept {
    out_.column(channel)[scan] = value;
    out_.quality(channel)[scan] = bits;
  }

  const physics::RigModel& rig_;
  physics::CopEstimator estimator_;
  core::Block out_;
  std::array<Sensor, kSensors> sensors_{};
};

/// All contenders on blocks of one size.
class Bench {
 public:
  explicit Bench(std::size_t block_scans) : block_scans_(block_scans), copy_(kSensors, block_scans) {
    const Signal signal = standing_volts(kSignalScans, 5, Faults::None);
    for (std::size_t first = 0; first < kSignalScans; first += block_scans) {
      blocks_.push_back({.block = core::Block(kSensors, block_scans), .gap_before = {}, .lost_scans_total = 0});
      fill_block(signal, first, block_scans, blocks_.back().block);
    }
    contenders_ = {{.name = "copy of the block", .step = copy()},
                   {.name = "fused loop, poly3", .step = fused(physics::CopMethod::Poly3)},
                   {.name = "fused loop, thesis", .step = fused(physics::CopMethod::Thesis)},
                   {.name = "guard", .step = pipeline(1, "poly3")},
                   {.name = "guard, window", .step = pipeline(2, "poly3")},
                   {.name = "guard, window, linearise", .step = pipeline(3, "poly3")},
                   {.name = "**floor pipeline, poly3**", .step = pipeline(4, "poly3")},
                   {.name = "**floor pipeline, thesis**", .step = pipeline(4, "thesis")}};
  }

  void run_round(std::size_t round, std::size_t scans) {
    for (std::size_t i = 0; i < contenders_.size(); ++i) {
      measure(contenders_[(i + round) % contenders_.size()], scans);  // nobody always runs first
    }
  }
  [[nodiscard]] const std::vector<Contender>& contenders() const { return contenders_; }

  /// The hand-written loop is a fair baseline only while it gives what the pipeline gives.
  void compare_results() {
    for (const auto& [method, name] : {std::pair{physics::CopMethod::Poly3, "poly3"}, {physics::CopMethod::Thesis, "thesis"}}) {
      const Step by_hand = fused(method);
      const Step by_stages = pipeline(4, name);
      std::uint64_t scan = 0;
      for (core::Acquired& acquired : blocks_) {
        acquired.block.first_scan = core::ScanIndex{scan};
        scan += block_scans_;
        const core::Block& expected = by_hand(acquired);
        const core::Block& block = by_stages(acquired);
        for (std::size_t c = 0; c < 3 && scan > 2; ++c) {
          require(std::abs(expected.column(c).back() - block.column(c).back()) < 1e-9, "the fused loop computes something else");
        }
      }
    }
  }

 private:
  Step copy() {
    return [this](const core::Acquired& acquired) -> const core::Block& {
      copy_.copy_position(acquired.block);
      for (std::size_t c = 0; c < kSensors; ++c) std::ranges::copy(acquired.block.column(c), copy_.column(c).begin());
      return copy_;
    };
  }
  Step fused(physics::CopMethod method) {
    return [loop = std::make_shared<FusedLoop>(surroundings_.rig, method, block_scans_)](
               const core::Acquired& acquired) -> const core::Block& { return loop->process(acquired.block); };
  }
  /// The first `stages` of the floor pipeline.
  Step pipeline(std::size_t stages, const std::string& estimator) {
    std::vector<StageConfig> configs{{"guard", {}}, {"window_filter", {}}, {"linearise", {}}, {"cop", {{"estimator", estimator}}}};
    configs.resize(stages);
    const PipelineInput input{
        .rate = rate_hz(100), .sensor_channels = {0, 1, 2, 3}, .aux_channels = {}, .aux_formats = {}, .max_block_scans = block_scans_};
    std::shared_ptr<Pipeline> chain = Pipeline::create(configs, input, surroundings_.context()).value();
    return [chain, frame = std::make_shared<core::Frame>(chain->make_frame())](const core::Acquired& acquired) -> const core::Block& {
      chain->process(acquired, *frame);
      return frame->streams.back();
    };
  }

  void measure(Contender& contender, std::size_t scans) {
    const std::uint64_t heap_before = test::heap_calls_of_this_thread();
    const std::int64_t start_ns = cpu_time_ns();
    for (std::size_t done = 0; done < scans; done += kSignalScans) {
      for (core::Acquired& acquired : blocks_) {
        acquired.block.first_scan = core::ScanIndex{contender.next_scan};
        contender.next_scan += block_scans_;
        contender.step(acquired);
      }
    }
    const std::int64_t end_ns = cpu_time_ns();
    contender.heap_calls += test::heap_calls_of_this_thread() - heap_before;
    contender.ns_per_scan.push_back(static_cast<double>(end_ns - start_ns) / static_cast<double>(scans));
  }

  std::size_t block_scans_;
  StageSurroundings surroundings_;
  std::vector<core::Acquired> blocks_;
  core::Block copy_;
  std::vector<Contender> contenders_;
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string cpu_model() {
  std::ifstream cpuinfo("/proc/cpuinfo");
  for (std::string line; std::getline(cpuinfo, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown CPU";
}

void print_table(const std::vector<std::unique_ptr<Bench>>& benches) {
  std::printf("| ns per scan of 4 channels, median (best) |");
  for (const std::size_t size : kBlockSizes) std::printf(" blocks of %zu |", size);
  std::printf(" million scans/s at 64 | heap calls |\n|---|---|---|---|---|---|---|");
  for (std::size_t i = 0; i < benches.front()->contenders().size(); ++i) {
    std::printf("\n| %s |", benches.front()->contenders()[i].name.c_str());
    std::uint64_t heap = 0;
    for (const auto& bench : benches) {
      const Contender& contender = bench->contenders()[i];
      std::printf(" %.1f (%.1f) |", median(contender.ns_per_scan), std::ranges::min(contender.ns_per_scan));
      heap += contender.heap_calls;
    }
    std::printf(" %.2f | %llu |", 1e3 / median(benches.back()->contenders()[i].ns_per_scan), static_cast<unsigned long long>(heap));
  }
  std::printf("\n");
}

}  // namespace
}  // namespace dts::pipeline

int main(int argc, char** argv) {
  std::size_t repetitions = 15;
  std::size_t scans = 262'144;
  CLI::App app{"Cost of one scan of four sensors through the floor pipeline, as a Markdown table"};
  app.add_option("--reps", repetitions, "rounds; the median counts")->check(CLI::Range(1, 10'000))->capture_default_str();
  app.add_option("--scans", scans, "scans per measurement, rounded up to a multiple of 4096")
      ->check(CLI::Range(1, 1 << 28))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  using namespace dts::pipeline;
  scans = (scans + kSignalScans - 1) / kSignalScans * kSignalScans;

  std::vector<std::unique_ptr<Bench>> benches;
  for (const std::size_t block_scans : kBlockSizes) {
    benches.push_back(std::make_unique<Bench>(block_scans));
    benches.back()->compare_results();
  }
  for (std::size_t round = 0; round < repetitions; ++round) {
    for (const auto& bench : benches) bench->run_round(round, scans);
  }
  std::printf("%s, g++ %s, CPU time, %zu interleaved rounds of %zu scans; goal %.1f million scans/s at 64\n\n", cpu_model().c_str(),
              __VERSION__, repetitions, scans, kGoalScansPerSecond * 1e-6);
  print_table(benches);
}
