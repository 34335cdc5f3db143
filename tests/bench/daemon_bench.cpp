// SPDX-License-Identifier: Apache-2.0
// What the real dtsd costs and how late its data are, as Markdown tables: processor time, context switches and memory;
// latency from a scan's instant to the moment a subscriber holds it decoded; losses beside a program that takes every core.
//
// The daemon runs as a child with the shipped rig file; "16 ch" is sim:floor with extra=12 and truth=0: 4 sensors and 12
// auxiliary channels. All five streams are published, and subscribers (processes of their own, on libdts) take all of them.
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bench/child.h"
#include "bench/process_use.h"
#include "system/daemon_process.h"

namespace {

using dts::bench::Child;
using dts::bench::Measured;

constexpr int kDaemonPriority = 50;  // the daemon's default
constexpr int kSubscriberPriority = 45;
constexpr double kLoadRateHz = 1500.0;

/// A dtsd to measure.
struct Build {
  std::string name;
  std::string program;
};

struct Settings {
  std::vector<Build> builds{{"this build", DTSD_PROGRAM}};
  double seconds = 5.0;
  int rounds = 3;
  double load_seconds = 60.0;
  bool has_fifo = false;
};

/// One way to run the daemon.
struct Setup {
  double rate_hz = kLoadRateHz;
  bool is_low_latency = false;
  bool is_fifo = true;
  std::string cpus;  ///< "1"; empty: all.
  std::string program = DTSD_PROGRAM;

  [[nodiscard]] bool is_large() const { return rate_hz > 1000.0; }
  [[nodiscard]] dts::test::DaemonProcess::Options options() const {
    return {.device = std::string("sim:floor?seed=7&truth=0&step_on_s=0") + (is_large() ? "&extra=12" : ""),
            .acquire = "rate_hz = " + std::to_string(rate_hz) + "\nlow_latency = " + (is_low_latency ? "true" : "false"),
            .stages = {},
            .daemon = "[realtime]\nfifo_priority = " + std::to_string(is_fifo ? kDaemonPriority : 0) + "\ncpus = [" + cpus + "]",
            .program = program};
  }
  [[nodiscard]] int subscriber_priority() const { return is_fifo ? kSubscriberPriority : 0; }
  [[nodiscard]] std::string name() const {
    return std::string(is_low_latency ? "1 scan" : "20 ms") + " | " + (is_fifo ? "FIFO" : "other") + " | " + (cpus.empty() ? "all" : cpus);
  }
};

void sleep_for(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

double load_average() {
  std::ifstream file("/proc/loadavg");
  double load = 0.0;
  file >> load;
  return load;
}

/// Starts `count` subscribers that measure for `seconds`; empty when one of them fails.
std::vector<Child> start_subscribers(const dts::test::DaemonProcess& daemon, int count, double seconds, int priority) {
  std::vector<Child> subscribers;
  for (int n = 0; n < count; ++n) subscribers.push_back(dts::bench::subscribe(daemon.data_endpoint(), seconds, priority));
  const bool are_ready = std::ranges::all_of(subscribers, [](const Child& child) { return child.wait_until_ready(); });
  if (!are_ready) subscribers.clear();
  return subscribers;
}

double percent(const dts::bench::UseRate& use, const std::string& thread) {
  const auto found = use.thread_percent.find(thread);
  return found == use.thread_percent.end() ? 0.0 : found->second;
}

/// Of the rig's thread; an older build has two.
double rig_percent(const dts::bench::UseRate& use, const std::string& rig) {
  return percent(use, "acq-" + rig) + percent(use, "pipe-" + rig);
}

/// The cells of one row: CPU by thread, switches and memory.
void print_use(const dts::bench::UseRate& use, const std::string& rig) {
  std::printf(" %.1f | %.2f | %.2f | %.2f | %.2f | %.2f |", use.cpu_percent, use.threads_percent, rig_percent(use, rig),
              percent(use, "publish"), percent(use, "ZMQbg/IO/0"), percent(use, "dtsd"));
}

void print_cost(const Settings& settings, const Build& build, Setup setup, int subscriber_count) {
  setup.program = build.program;
  const dts::test::DaemonProcess daemon(setup.options());
  if (!daemon.is_ready()) {
    std::printf("| the daemon did not start: %s |\n", daemon.log().c_str());
    return;
  }
  const auto subscribers = start_subscribers(daemon, subscriber_count, settings.seconds + 1.0, setup.subscriber_priority());
  sleep_for(0.5);
  const auto before = dts::bench::observe(daemon.pid());
  sleep_for(settings.seconds);
  const auto use = dts::bench::between(before, dts::bench::observe(daemon.pid()));
  std::printf("| %s | %d ch x %.0f Hz | %s | %d |", build.name.c_str(), setup.is_large() ? 16 : 4, setup.rate_hz, setup.name().c_str(),
              subscriber_count);
  print_use(use, "floor");
  std::printf(" %.2f | %.0f |\n", use.switches_per_s / setup.rate_hz, static_cast<double>(dts::test::resident_kb(daemon.pid())) / 1024.0);
  std::fflush(stdout);
}

void print_costs(const Settings& settings) {
  std::printf("\n### Cost of the daemon (%.0f s per row, load average %.1f at the start)\n\n", settings.seconds, load_average());
  std::printf(
      "CPU in %% of one core: utime + stime (steps of 10 ms), then by thread (to the ns). Subscribers are processes of their own.\n\n"
      "| dtsd | rig | block | policy | cores | subscribers | CPU | all threads | rig | publish | libzmq | control |"
      " switches per scan | RSS MiB |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const double rate_hz : {100.0, kLoadRateHz}) {
    for (const bool is_low_latency : {false, true}) {
      for (const int subscribers : {0, 1, 4}) {
        for (const Build& build : settings.builds) {
          print_cost(settings, build, {.rate_hz = rate_hz, .is_low_latency = is_low_latency, .is_fifo = settings.has_fifo}, subscribers);
        }
      }
    }
  }
  for (const Build& build : settings.builds) {
    print_cost(settings, build, {.is_low_latency = true, .is_fifo = settings.has_fifo, .cpus = "1"}, 4);
  }
}

/// The rigs of config/dtsd.toml.
dts::test::DaemonProcess::Options demo_options(const Build& build) {
  std::string stages;
  for (const char* stage : {"guard", "window_filter", "linearise", "cop", "steadiness"}) {
    stages += std::string("[[stage]]\nid = \"") + stage + "\"\n";
  }
  return {.device = "sim:floor?seed=7",
          .acquire = {},
          .stages = stages,
          .daemon = {},
          .further_rigs = {{.name = "chair", .device = "sim:chair?seed=5", .file = "chair-sim.toml"}},
          .program = build.program};
}

/// What the two simulated devices use without a daemon, in % of one core.
double measure_simulators(const Settings& settings) {
  return dts::bench::run_devices(DTS_SOURCE_DIR "/config/dtsd.toml", settings.seconds).result().cpu_percent;
}

double median_of(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

void print_demo(const Settings& settings) {
  std::printf("\n### The idle demo: floor and chair, simulated, no subscriber (median of %d rounds of %.0f s, load average %.1f)\n\n",
              settings.rounds, settings.seconds, load_average());
  std::printf(
      "CPU in %% of one core. Simulators: both devices, read at the same rates by a program that does nothing else.\n\n"
      "| dtsd | CPU | rig | publish | control | switches/s | RSS MiB | simulators "
      "|\n|---|---|---|---|---|---|---|---|\n");
  constexpr std::size_t kCells = 7;
  std::vector<std::array<std::vector<double>, kCells>> cells(settings.builds.size());
  for (int round = 0; round < settings.rounds; ++round) {
    const double simulators = measure_simulators(settings);
    for (std::size_t n = 0; n < settings.builds.size(); ++n) {
      const dts::test::DaemonProcess daemon(demo_options(settings.builds[n]));
      sleep_for(1.0);
      const auto before = dts::bench::observe(daemon.pid());
      sleep_for(settings.seconds);
      const auto use = dts::bench::between(before, dts::bench::observe(daemon.pid()));
      const std::array<double, kCells> row{use.threads_percent,
                                           rig_percent(use, "floor") + rig_percent(use, "chair"),
                                           percent(use, "publish"),
                                           percent(use, "dtsd"),
                                           use.switches_per_s,
                                           static_cast<double>(dts::test::resident_kb(daemon.pid())) / 1024.0,
                                           simulators};
      for (std::size_t cell = 0; cell < kCells; ++cell) cells[n][cell].push_back(row[cell]);
    }
  }
  for (std::size_t n = 0; n < settings.builds.size(); ++n) {
    std::printf("| %s |", settings.builds[n].name.c_str());
    for (const std::vector<double>& values : cells[n]) std::printf(" %.2f |", median_of(values));
    std::printf("\n");
  }
  std::fflush(stdout);
}

Measured measure_daemon(const Settings& settings, const Setup& setup) {
  const dts::test::DaemonProcess daemon(setup.options());
  auto subscribers = start_subscribers(daemon, 1, settings.seconds, setup.subscriber_priority());
  return subscribers.empty() ? Measured{} : subscribers.front().result();
}

Measured measure_plain(const Settings& settings, bool is_fifo) {
  const auto directory = std::filesystem::temp_directory_path() / ("dts-bench-" + std::to_string(::getpid()));
  std::filesystem::create_directory(directory);
  const std::string endpoint = "ipc://" + (directory / "plain.sock").string();
  Measured measured;
  {
    const Child publisher = dts::bench::publish_plain(endpoint, kLoadRateHz, settings.seconds + 5.0, is_fifo ? kDaemonPriority : 0);
    Child receiver = dts::bench::receive_plain(endpoint, settings.seconds, is_fifo ? kSubscriberPriority : 0);
    if (receiver.wait_until_ready()) measured = receiver.result();
  }
  std::filesystem::remove_all(directory);
  return measured;
}

/// Medians of several rounds, each number for itself.
Measured median(const std::vector<Measured>& rounds) {
  const auto of = [&](double Measured::*field) {
    std::vector<double> values;
    for (const Measured& round : rounds) values.push_back(round.*field);
    std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
    return values[values.size() / 2];
  };
  Measured result{
      .p50_us = of(&Measured::p50_us), .p99_us = of(&Measured::p99_us), .p999_us = of(&Measured::p999_us), .max_us = of(&Measured::max_us)};
  for (const Measured& round : rounds) result.samples += round.samples;
  return result;
}

void print_latency(const char* what, const Measured& measured, const Measured& plain) {
  std::printf("| %s | %.0f | %.0f | %.0f | %.0f | %llu | %.2f | %.2f |\n", what, measured.p50_us, measured.p99_us, measured.p999_us,
              measured.max_us, static_cast<unsigned long long>(measured.samples), measured.p50_us / plain.p50_us,
              measured.p99_us / plain.p99_us);
}

/// All setups of one policy, round after round, so that a disturbance of the machine hits all of them.
void print_latencies_of(const Settings& settings, bool is_fifo) {
  std::vector<Setup> setups;
  for (const bool is_low_latency : {true, false}) {
    for (const char* cpus : {"", "1"}) setups.push_back({.is_low_latency = is_low_latency, .is_fifo = is_fifo, .cpus = cpus});
  }
  std::vector<std::vector<Measured>> measured(setups.size());
  std::vector<Measured> ticks;
  std::vector<Measured> plain;
  for (int round = 0; round < settings.rounds; ++round) {
    ticks.push_back(dts::bench::tick(kLoadRateHz, settings.seconds, is_fifo ? kDaemonPriority : 0).result());
    plain.push_back(measure_plain(settings, is_fifo));
    for (std::size_t n = 0; n < setups.size(); ++n) measured[n].push_back(measure_daemon(settings, setups[n]));
  }
  const Measured pair = median(plain);
  const std::string policy = is_fifo ? " | FIFO | all" : " | other | all";
  print_latency(("bare tick: lateness of an absolute sleep | 1 scan" + policy).c_str(), median(ticks), pair);
  print_latency(("plain libzmq PUB/SUB, protobuf, 16 ch | 1 scan" + policy).c_str(), pair, pair);
  for (std::size_t n = 0; n < setups.size(); ++n) print_latency(("dtsd, cop | " + setups[n].name()).c_str(), median(measured[n]), pair);
  std::fflush(stdout);
}

void print_latencies(const Settings& settings) {
  std::printf("\n### Latency at %.0f Hz, us (median of %d rounds of %.0f s, load average %.1f at the start)\n\n", kLoadRateHz,
              settings.rounds, settings.seconds, load_average());
  std::printf(
      "From the newest scan's instant to the moment the subscriber holds it decoded. FIFO: daemon %d to %d, subscriber %d.\n"
      "20 ms blocks come 50 times per second: read no p99.9 there.\n\n"
      "| what | block | policy | cores | p50 | p99 | p99.9 | max | samples | p50 / plain | p99 / plain |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n",
      kDaemonPriority, kDaemonPriority - 3, kSubscriberPriority);
  if (settings.has_fifo) print_latencies_of(settings, true);
  print_latencies_of(settings, false);
}

/// stress-ng for as long as this object lives.
class Stress {
 public:
  Stress() : pid_(::fork()) {
    if (pid_ != 0) return;
    ::setpgid(0, 0);
    ::execlp("stress-ng", "stress-ng", "--quiet", "--cpu", "2", static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ~Stress() {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
  }
  Stress(const Stress&) = delete;
  Stress& operator=(const Stress&) = delete;
  [[nodiscard]] static bool is_installed() { return dts::test::run_program({"/bin/sh", "-c", "command -v stress-ng"}).status == 0; }

 private:
  pid_t pid_;
};

void print_load_test(const Settings& settings, const Setup& setup) {
  const dts::test::DaemonProcess daemon(setup.options());
  const Stress stress;
  sleep_for(1.0);  // until it is at full speed
  auto subscribers = start_subscribers(daemon, 1, settings.load_seconds, setup.subscriber_priority());
  const Measured seen = subscribers.empty() ? Measured{} : subscribers.front().result();
  const auto status = daemon.control().status();
  const bool has_rig = status && status->rigs_size() == 1;
  const auto unexplained = static_cast<long long>(seen.expected) - static_cast<long long>(seen.received + seen.told_lost + seen.gap_scans);
  std::printf("| %s | %llu | %llu | %llu | %llu | %lld | %llu | %.0f | %.0f | %.0f | %.0f |\n", setup.name().c_str(),
              static_cast<unsigned long long>(seen.expected), static_cast<unsigned long long>(seen.received),
              static_cast<unsigned long long>(seen.gap_scans), static_cast<unsigned long long>(seen.told_lost), unexplained,
              static_cast<unsigned long long>(has_rig ? status->rigs(0).lost_scans_total() : 0), seen.p50_us, seen.p99_us, seen.p999_us,
              seen.max_us);
  std::fflush(stdout);
}

void print_load_tests(const Settings& settings) {
  std::printf("\n### 16 channels at %.0f Hz for %.0f s beside `stress-ng --cpu 2`\n\n", kLoadRateHz, settings.load_seconds);
  if (!Stress::is_installed()) {
    std::printf("Skipped: stress-ng is not installed (Debian package stress-ng).\n");
    return;
  }
  std::printf(
      "Expected: scans between the host times of the first and the last. Unexplained = expected - received - gaps - lost on the"
      " way; it must be 0.\n\n"
      "| block | policy | cores | expected | received | in gaps | lost on the way | unexplained | lost, by the daemon's status |"
      " p50 us | p99 | p99.9 | max |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const bool is_low_latency : {true, false}) {
    if (settings.has_fifo) print_load_test(settings, {.is_low_latency = is_low_latency, .is_fifo = true});
    print_load_test(settings, {.is_low_latency = is_low_latency, .is_fifo = false});
  }
  if (settings.has_fifo) print_load_test(settings, {.is_low_latency = true, .is_fifo = true, .cpus = "1"});
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"daemon_bench - what dtsd costs and how late its data are"};
  Settings settings;
  bool is_quick = false;
  std::string part;
  std::string older;
  app.add_flag("--quick", is_quick, "Short windows: shows that everything works, the figures are rough");
  app.add_option("--seconds", settings.seconds, "Length of a measurement")->check(CLI::Range(0.5, 3600.0));
  app.add_option("--rounds", settings.rounds, "Interleaved rounds of the latency and demo tables")->check(CLI::Range(1, 100));
  app.add_option("--load-seconds", settings.load_seconds, "Length of the load test")->check(CLI::Range(1.0, 86400.0));
  app.add_option("--part", part, "One table only")->check(CLI::IsMember({"cost", "demo", "latency", "load"}));
  app.add_option("--before", older, "dtsd of an older build, for the tables of cost and demo")->check(CLI::ExistingFile);
  CLI11_PARSE(app, argc, argv);
  if (is_quick) settings = {.seconds = 1.0, .rounds = 1, .load_seconds = 5.0};
  if (!older.empty()) settings.builds.insert(settings.builds.begin(), {"before", older});
  settings.has_fifo = dts::bench::may_use_fifo(kDaemonPriority);

  std::printf("## daemon_bench\n");
  if (!settings.has_fifo) std::printf("\nSCHED_FIFO is not permitted here: rows with policy FIFO are left out.\n");
  if (part.empty() || part == "cost") print_costs(settings);
  if (part.empty() || part == "demo") print_demo(settings);
  if (part.empty() || part == "latency") print_latencies(settings);
  if (part.empty() || part == "load") print_load_tests(settings);
  return 0;
}
