// SPDX-License-Identifier: Apache-2.0
// What all measures of a trial of quiet standing cost, by part, on one core; what a day of standing costs in the live stage; and with
// --numpy the same formulas written straight down with NumPy and SciPy, run in the same run on the same data. Input is a synthetic sway,
// with --data also the recordings of a folder. CPU time; rounds are interleaved; the tables show medians and the middle 80 %.
#include <time.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "core/worker.h"
#include "pipeline/stage_registry.h"
#include "posturography/analysis.h"
#include "posturography/diffusion.h"
#include "posturography/entropy.h"
#include "posturography/spectrum.h"
#include "posturography/time_domain.h"
#include "session/sway_results.h"
#include "support/allocation_counter.h"

namespace dts {
namespace {

using namespace posturography;

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "sway_bench: %s\n", why.c_str());
  std::exit(EXIT_FAILURE);
}

/// Time this thread has had a core.
double cpu_time_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

struct Trial {
  std::string name;
  CopSeries series;
};

/// Slow sway, faster sway and the noise of a sensor.
CopSeries synthetic(double rate_hz, std::size_t samples) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise;
  CopSeries series{.rate_hz = rate_hz};
  const double keep = std::exp(-1.0 / rate_hz);
  const double push = std::sqrt(1.0 - keep * keep);
  double ml_mm = 0.0;
  double ap_mm = 0.0;
  for (std::size_t n = 0; n < samples; ++n) {
    const double t_s = static_cast<double>(n) / rate_hz;
    ml_mm = keep * ml_mm + 3.0 * push * noise(random);
    ap_mm = keep * ap_mm + 6.0 * push * noise(random);
    series.ml_mm.push_back(12.0 + ml_mm + 0.4 * std::sin(2.0 * std::numbers::pi * 0.8 * t_s) + 0.02 * noise(random));
    series.ap_mm.push_back(-40.0 + ap_mm + 0.8 * std::sin(2.0 * std::numbers::pi * 0.4 * t_s) + 0.02 * noise(random));
  }
  return series;
}

/// Columns t_s, x_mm (ML), y_mm (AP).
std::optional<CopSeries> recording(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::vector<double> columns[3];
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    for (auto& column : columns) {
      double value = 0.0;
      char comma = 0;
      cells >> value >> comma;
      column.push_back(value);
    }
  }
  auto series = even_series(columns[0], columns[1], columns[2]);
  if (!series) return std::nullopt;
  return *series;
}

std::vector<Trial> trials_of(const std::string& folder) {
  std::vector<Trial> trials{{"60 s, 100 Hz, 6000 samples", synthetic(100.0, 6000)},
                            {"the same, 5987 samples (a prime)", synthetic(100.0, 5987)},
                            {"60 s, 1500 Hz, 90 000 samples", synthetic(1500.0, 90'000)}};
  if (folder.empty()) return trials;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".csv") files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const auto& file : files) {
    if (auto series = recording(file)) trials.push_back({file.stem().string(), std::move(*series)});
  }
  return trials;
}

constexpr const char* kParts[] = {"prepare", "time domain", "spectra", "random walk", "entropy", "all"};
using Times = std::map<std::string, std::vector<double>>;  ///< ms

std::vector<double> every(const std::vector<double>& values, std::size_t step) {
  std::vector<double> kept;
  for (std::size_t n = 0; n < values.size(); n += step) kept.push_back(values[n]);
  return kept;
}

void measure(const Trial& trial, Times& times, Measures& measures) {
  double begun_ms = cpu_time_ms();
  const auto lap = [&](const char* part) {
    times[part].push_back(cpu_time_ms() - begun_ms);
    begun_ms = cpu_time_ms();
  };
  const auto prepared = prepare(trial.series, kReportPreparation);
  if (!prepared) give_up(core::to_string(prepared.error()));
  lap("prepare");
  Measures parts;
  add_time_domain(*prepared, parts);
  add_velocity_and_direction(*prepared, std::nullopt, parts);
  lap("time domain");
  add_frequency_domain(*prepared, multitaper_spectra(*prepared), true, parts);
  lap("spectra");
  add_random_walk(*prepared, mean_square_displacement(*prepared), true, parts);
  lap("random walk");
  const auto step = static_cast<std::size_t>(std::round(prepared->rate_hz / 20.0));
  static_cast<void>(sample_entropy(every(prepared->ap_mm, step)));
  static_cast<void>(sample_entropy(every(prepared->ml_mm, step)));
  lap("entropy");
  const auto analysis = analyse(trial.series, {.preparation = kReportPreparation});
  lap("all");
  if (analysis) measures = analysis->measures;
}

double quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5)];
}

/// What the NumPy program says: "time PART ms" and "value SYMBOL number".
struct Peer {
  std::map<std::string, double> ms;
  std::map<std::string, double> values;
};

std::optional<Peer> run_peer(const Trial& trial) {
  const auto stem = (std::filesystem::temp_directory_path() / ("sway_bench_" + std::to_string(::getpid()))).string();
  std::ofstream rows(stem + ".csv");
  rows.precision(17);
  for (std::size_t n = 0; n < trial.series.ml_mm.size(); ++n) rows << trial.series.ml_mm[n] << ',' << trial.series.ap_mm[n] << '\n';
  rows.close();
  const std::string call = "/usr/bin/python3 " DTS_SOURCE_DIR "/tests/bench/sway_peers.py " + stem + ".csv " +
                           std::to_string(trial.series.rate_hz) + " >" + stem + ".txt";
  const bool is_fine = std::system(call.c_str()) == 0;
  Peer peer;
  std::ifstream told(stem + ".txt");
  std::string line;
  while (std::getline(told, line)) {
    std::istringstream words(line);
    std::string kind, name;
    double number = 0.0;
    if (!(std::getline(words, kind, '\t') && std::getline(words, name, '\t') && words >> number)) continue;
    (kind == "time" ? peer.ms : peer.values)[name] = number;
  }
  std::filesystem::remove(stem + ".csv");
  std::filesystem::remove(stem + ".txt");
  if (!is_fine || peer.ms.empty()) return std::nullopt;
  return peer;
}

void print_agreement(const Peer& peer, const Measures& measures) {
  double worst = 0.0;
  std::string where = "-";
  std::size_t compared = 0;
  for (const auto& [symbol, value] : peer.values) {
    const auto measure = measure_named(symbol);
    const auto own = measure ? measures.get(*measure) : std::nullopt;
    if (!own) continue;
    ++compared;
    const double off = std::abs(*own - value) / std::max(std::abs(value), 1e-300);
    if (off <= worst) continue;
    worst = off;
    where = symbol;
  }
  std::printf("\n%zu measures compared; largest relative difference %.1e (%s)\n", compared, worst, where.c_str());
}

void print(const Trial& trial, const Times& times, const Measures& measures, bool with_numpy) {
  const auto peer = with_numpy ? run_peer(trial) : std::nullopt;
  std::printf("\n%s\n\n| part | ms, median (10 .. 90 %%) |%s\n|---|---|%s\n", trial.name.c_str(), peer ? " NumPy, ms | times ours |" : "",
              peer ? "---|---|" : "");
  for (const char* part : kParts) {
    const auto& values = times.at(part);
    const double ms = quantile(values, 0.5);
    std::printf("| %s | %.2f (%.2f .. %.2f) |", part, ms, quantile(values, 0.1), quantile(values, 0.9));
    if (peer && peer->ms.contains(part)) std::printf(" %.2f | %.1f |", peer->ms.at(part), peer->ms.at(part) / ms);
    std::printf("\n");
  }
  if (peer) print_agreement(*peer, measures);
  if (with_numpy && !peer) std::printf("\nNumPy is left out: /usr/bin/python3 cannot import numpy and scipy, or failed\n");
}

/// A standing person through the stage `steadiness`, the same minute over and over.
void measure_live(double hours, double rate_hz, std::size_t block_scans) {
  const physics::RigModel rig;
  pipeline::Tare tare;
  pipeline::SteadinessWindows windows;
  auto stage =
      pipeline::create_stage({.id = "steadiness", .options = {}}, {.rig = rig, .input_ranges = {}, .tare = tare, .windows = windows});
  if (!stage) give_up(core::to_string(stage.error()));
  const core::StreamFormat format{
      .name = "cop",
      .rate = core::Rate::from_hz(rate_hz).value(),
      .channels = {{.name = "ml_mm", .unit = "mm"}, {.name = "ap_mm", .unit = "mm"}, {.name = "load_n", .unit = "N"}}};
  if (const auto prepared = (*stage)->prepare(format, block_scans); !prepared) give_up(core::to_string(prepared.error()));
  const CopSeries minute = synthetic(rate_hz, static_cast<std::size_t>(60.0 * rate_hz));
  core::Block in(3, block_scans);
  core::Block out(0, block_scans);
  in.set_count(block_scans);
  std::ranges::fill(in.column(2), 700.0);
  core::FrameEvents events;
  const auto scans = static_cast<std::uint64_t>(hours * 3600.0 * rate_hz);
  std::uint64_t told = 0;
  const std::uint64_t heap_before = test::heap_calls_of_this_thread();
  const double begun_ms = cpu_time_ms();
  for (std::uint64_t scan = 0; scan < scans; scan += block_scans) {
    const auto place = static_cast<std::ptrdiff_t>(scan % minute.ml_mm.size());
    std::copy_n(minute.ml_mm.begin() + place, block_scans, in.column(0).begin());
    std::copy_n(minute.ap_mm.begin() + place, block_scans, in.column(1).begin());
    in.first_scan.value = scan;
    events.clear();
    (*stage)->process(in, out);
    (*stage)->tell(events);
    told += events.sways.count;
  }
  const double spent_ms = cpu_time_ms() - begun_ms;
  std::printf("| %.3g h at %.0f Hz, blocks of %zu | %.2f | %.1f | %.2e | %llu | %llu |\n", hours, rate_hz, block_scans, spent_ms * 1e-3,
              spent_ms * 1e6 / static_cast<double>(scans), hours * 3.6e6 / spent_ms, static_cast<unsigned long long>(told),
              static_cast<unsigned long long>(test::heap_calls_of_this_thread() - heap_before));
}

double wall_ms() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// A whole trial as the control thread processes it: blocks of 50 ms, the end of the trial, and its result from the worker thread.
void measure_trial(double minutes, double rate_hz) {
  const CopSeries minute = synthetic(rate_hz, static_cast<std::size_t>(60.0 * rate_hz));
  const auto block_scans = static_cast<std::size_t>(0.05 * rate_hz);
  const auto scans = static_cast<std::uint64_t>(minutes * 60.0 * rate_hz);
  core::Worker worker("analyse");
  const core::Rate rate = core::Rate::from_hz(rate_hz).value();
  session::SwayResults results(rate, rate, worker);
  core::Block block(3, block_scans);
  block.set_count(block_scans);
  std::ranges::fill(block.column(2), 700.0);
  double longest_ms = 0.0;
  const auto timed = [&longest_ms](auto call) {
    const double begun_ms = cpu_time_ms();
    call();
    longest_ms = std::max(longest_ms, cpu_time_ms() - begun_ms);
  };
  results.take({.kind = session::TrialEventKind::Measure, .trial = 1, .condition = "open"}, 0, {0});
  for (std::uint64_t scan = 0; scan < scans + block_scans * 10; scan += block_scans) {
    const auto place = static_cast<std::ptrdiff_t>(scan % minute.ml_mm.size());
    std::copy_n(minute.ml_mm.begin() + place, block_scans, block.column(0).begin());
    std::copy_n(minute.ap_mm.begin() + place, block_scans, block.column(1).begin());
    block.first_scan.value = scan;
    if (scan == scans) results.take({.kind = session::TrialEventKind::Done, .trial = 1, .condition = "open"}, 0, {scans});
    timed([&] { results.take(block); });
  }
  const double ended_ms = wall_ms();
  results.wait();
  const double analysed_ms = wall_ms() - ended_ms;
  std::vector<session::SwayTrialResult> decided;
  timed([&] { decided = results.take_decided(); });
  if (decided.size() != 1 || !decided[0].analysis) give_up("the trial has no result");
  std::printf("| %.3g min at %.0f Hz | %.1f | %.0f |\n", minutes, rate_hz, longest_ms, analysed_ms);
}

}  // namespace
}  // namespace dts

int main(int argc, char** argv) {
  std::size_t repetitions = 31;
  std::string folder;
  bool with_numpy = false;
  double hours = 24.0;
  CLI::App app{"Cost of the measures of quiet standing, by part, as Markdown tables"};
  app.add_option("--reps", repetitions, "rounds; the median counts")->check(CLI::Range(1, 10'000))->capture_default_str();
  app.add_option("--data", folder, "folder of recordings, CSV: t_s, x_mm, y_mm")->check(CLI::ExistingDirectory);
  app.add_flag("--numpy", with_numpy, "also the straightforward NumPy program, as ratios");
  app.add_option("--hours", hours, "of standing at 100 Hz through the live stage")->check(CLI::Range(0.0, 1000.0))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  using namespace dts;
  const std::vector<Trial> trials = trials_of(folder);
  std::vector<Times> times(trials.size());
  std::vector<posturography::Measures> measures(trials.size());
  for (std::size_t round = 0; round < repetitions; ++round) {
    for (std::size_t k = 0; k < trials.size(); ++k) {
      const std::size_t which = (k + round) % trials.size();
      measure(trials[which], times[which], measures[which]);
    }
  }
  std::printf("Steadiness of one trial (profile lp10, analysed at 100 Hz): CPU time, %zu interleaved rounds\n", repetitions);
  for (std::size_t k = 0; k < trials.size(); ++k) print(trials[k], times[k], measures[k], with_numpy);
  std::printf("\n| live stage | CPU s | ns per scan | times real time | events | heap calls |\n|---|---|---|---|---|---|\n");
  measure_live(hours, 100.0, 2);
  measure_live(hours / 24.0, 1500.0, 30);
  std::printf("\n| trial | longest call of the control thread, CPU ms | analysis on the worker, ms |\n|---|---|---|\n");
  measure_trial(1.0, 100.0);
  measure_trial(1.0, 1500.0);
  measure_trial(10.0, 1500.0);
}
