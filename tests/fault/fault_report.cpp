// SPDX-License-Identifier: Apache-2.0
// The long form of the tests in this folder, with figures: see README.md and scripts/fault.
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <mutex>
#include <random>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "fault/child_process.h"
#include "fault/hours.h"
#include "fault/injection.h"
#include "fault/kills.h"
#include "fault/pair_kills.h"
#include "fault/power_cut.h"
#include "fault/rigs.h"

namespace dts::fault {
namespace {

constexpr int kRoundsPerFolder = 20;  // then a new one: catalogues of thousands of killed sessions are not what is asked for

/// One line on a terminal; nothing elsewhere.
void draw_progress(std::size_t done, std::size_t of) {
  constexpr std::size_t kColumns = 40;
  if (::isatty(STDERR_FILENO) == 0) return;
  const std::size_t filled = of == 0 ? kColumns : kColumns * done / of;
  const std::string bar = std::string(filled, '#') + std::string(kColumns - filled, '.');
  std::fprintf(stderr, "\r[%s] %zu of %zu%s", bar.c_str(), done, of, done == of ? "\n" : "");
}

class Distribution {
 public:
  void add(double value) { values_.push_back(value); }
  void print_row(const char* name) {
    std::ranges::sort(values_);
    if (values_.empty()) return;
    const auto at = [this](double part) { return values_[static_cast<std::size_t>(part * static_cast<double>(values_.size() - 1))]; };
    std::printf("| %s | %.3f | %.3f | %.3f | %.3f |\n", name, at(0.0), at(0.5), at(0.95), at(1.0));
  }

 private:
  std::vector<double> values_;
};

int print_problems(const std::vector<std::string>& problems) {
  if (problems.empty()) {
    std::printf("\nEvery promise was kept.\n");
    return 0;
  }
  std::printf("\n%zu broken promises:\n\n", problems.size());
  for (const std::string& problem : problems) std::printf("- %s\n", problem.c_str());
  return 1;
}

/// What all workers have found.
struct KillTable {
  std::mutex mutex;
  std::size_t done = 0;
  Distribution recorded_s, lost_s, published_lost_s, told_s;
  std::vector<std::string> problems;
  std::size_t too_little_told = 0;

  void add(const Killed& killed, std::size_t of) {
    const std::lock_guard lock(mutex);
    recorded_s.add(killed.recorded_s);
    lost_s.add(killed.lost_s);
    published_lost_s.add(killed.published_lost_s);
    told_s.add(killed.told_lost_s_at_most);
    if (killed.published_lost_s > killed.told_lost_s_at_most) ++too_little_told;
    if (!killed.problem.empty()) problems.push_back(killed.problem + " (killed after " + std::to_string(killed.recorded_s) + " s)");
    draw_progress(++done, of);
  }
};

int kills(std::size_t rounds, std::size_t jobs, double longest_s, std::uint32_t seed) {
  const Reference reference = Reference::compute(floor16_rig(), 120.0);
  KillTable table;
  std::atomic<std::size_t> next{0};
  const auto work = [&](std::size_t worker) {
    std::unique_ptr<KillLine> line;
    for (int round = 0; next.fetch_add(1) < rounds; ++round) {
      if (round % kRoundsPerFolder == 0) line.reset();
      if (!line)
        line = std::make_unique<KillLine>(reference, seed + static_cast<std::uint32_t>(worker * 1000 + static_cast<std::size_t>(round)));
      table.add(line->run_round(longest_s), rounds);
    }
  };
  {
    std::vector<std::jthread> workers;
    for (std::size_t worker = 0; worker < jobs; ++worker) workers.emplace_back(work, worker);
  }
  std::printf("%zu SIGKILLs at random moments of recording 16 channels at 1500 Hz, %zu daemons side by side on %u cores, seed %u\n\n",
              rounds, jobs, std::thread::hardware_concurrency(), seed);
  std::printf("| s | min | p50 | p95 | max |\n|---|---|---|---|---|\n");
  table.recorded_s.print_row("recorded until the kill");
  table.lost_s.print_row("lost: kill - last time stamp recovered");
  table.published_lost_s.print_row("of it published before the kill");
  table.told_s.print_row("lost at most, as the catalogue says");
  std::printf("\n%zu recoveries said less than had been lost of what was published.\n", table.too_little_told);
  return print_problems(table.problems);
}

/// Kills the daemon of one session over two rigs.
int pair_kills(std::size_t rounds, double longest_s, std::uint32_t seed) {
  const Reference reference = Reference::compute(floor4_rig(), 600.0);
  PairKills line(seed);
  std::string problem;
  for (std::size_t round = 0; problem.empty() && round < rounds; ++round) {
    problem = line.run_round(longest_s);
    draw_progress(round + 1, rounds);
  }
  if (problem.empty()) problem = line.finish(reference);
  std::printf("%zu SIGKILLs of a session over two rigs, seed %u: %s\n", rounds, seed,
              problem.empty() ? "it continued each time, and all its recordings are whole" : problem.c_str());
  return problem.empty() ? 0 : 1;
}

/// Works off every `step`-th fault and sends a line for each: no threads, so that it can fork.
[[noreturn]] void inject_some(const std::vector<Fault>& faults, std::size_t first, std::size_t step, const Reference& reference,
                              int output) {
  for (std::size_t i = first; i < faults.size(); i += step) {
    const Injected injected = inject(faults[i], reference);
    std::string line = std::to_string(i) + "\t" + (injected.has_struck ? "1" : "0") + "\t" + injected.outcome + "\t" + injected.problem;
    std::ranges::replace(line, '\n', ' ');
    line.resize(std::min<std::size_t>(line.size(), 4000));  // a pipe takes so much at once
    line += '\n';
    if (::write(output, line.data(), line.size()) < 0) break;
  }
  ::_exit(0);
}

struct InjectTable {
  std::map<std::string, std::map<std::string, std::size_t>> outcomes;  ///< By operation.
  std::vector<std::string> problems;
  std::size_t done = 0;

  void add(const std::vector<Fault>& faults, const std::string& line) {
    std::istringstream fields(line);
    std::string number, struck, outcome, problem;
    std::getline(fields, number, '\t');
    std::getline(fields, struck, '\t');
    std::getline(fields, outcome, '\t');
    std::getline(fields, problem);
    const Fault& fault = faults.at(std::stoul(number));
    ++outcomes[std::string(name(fault.operation))][struck == "1" ? outcome : "not reached"];
    if (!problem.empty()) problems.push_back(to_text(fault) + ": " + problem);
    draw_progress(++done, faults.size());
  }
};

void print(InjectTable& table, const CallCounts& counts, std::size_t faults) {
  std::printf("%zu faults (ENOSPC, EIO, EDQUOT, EROFS in turn; once and lasting), one a session\n\n", faults);
  const std::vector<std::string> columns{"refused", "complete", "incomplete", "recovered", "not reached"};
  std::printf("| fails | calls |");
  for (const std::string& column : columns) std::printf(" %s |", column.c_str());
  std::printf("\n|---|---|---|---|---|---|---|\n");
  for (const Operation operation : kOperations) {
    const auto calls = static_cast<unsigned long long>(counts.calls[static_cast<std::size_t>(operation)]);
    std::printf("| %s | %llu |", std::string(name(operation)).c_str(), calls);
    for (const std::string& column : columns) std::printf(" %zu |", table.outcomes[std::string(name(operation))][column]);
    std::printf("\n");
  }
}

/// Forks the workers and gathers what they send until the last has ended.
InjectTable inject_side_by_side(const std::vector<Fault>& faults, std::size_t jobs, const Reference& reference) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  std::vector<pid_t> workers;
  for (std::size_t worker = 0; worker < jobs; ++worker) {
    workers.push_back(::fork());
    if (workers.back() == 0) inject_some(faults, worker, jobs, reference, ends[1]);
  }
  ::close(ends[1]);
  InjectTable table;
  FILE* const lines = ::fdopen(ends[0], "r");
  std::array<char, 8192> line{};
  while (std::fgets(line.data(), static_cast<int>(line.size()), lines) != nullptr) {
    std::string text = line.data();
    if (text.ends_with('\n')) text.pop_back();
    table.add(faults, text);
  }
  std::fclose(lines);
  for (const pid_t worker : workers) ::waitpid(worker, nullptr, 0);
  if (table.done < faults.size())
    table.problems.push_back(std::to_string(faults.size() - table.done) + " faults were not tried: a worker died");
  return table;
}

int inject_all(std::size_t jobs, std::size_t every) {
  const Reference reference = little_reference();
  const CallCounts counts = count_calls(reference);
  if (!counts.problem.empty()) throw std::runtime_error("without a fault: " + counts.problem);
  std::vector<Fault> faults;
  for (const Fault& fault : all_faults(counts)) {
    if (fault.nth % every == 0 || fault.nth == 1) faults.push_back(fault);
  }
  InjectTable table = inject_side_by_side(faults, jobs, reference);
  print(table, counts, faults.size());
  return print_problems(table.problems);
}

/// `disk` is the file system of a disk whose power fails, or empty: the model in memory.
int power(std::size_t cuts, double seconds, const std::string& disk, std::uint32_t seed) {
  constexpr std::size_t kCutsOfASession = 50;
  const Reference reference = Reference::compute(floor16_rig(), 60.0 + seconds);
  Distribution recorded_s, lost_s, told_s;
  std::vector<std::string> problems;
  for (std::size_t done = 0; done < cuts;) {
    const std::size_t count = std::min(kCutsOfASession, cuts - done);
    const std::uint32_t session_seed = seed + static_cast<std::uint32_t>(done);
    for (const PowerCut& cut : disk.empty() ? cut_power(seconds, count, session_seed, reference)
                                            : cut_power_of_disk(disk, seconds, count, session_seed, reference)) {
      recorded_s.add(cut.recorded_s);
      lost_s.add(cut.lost_s);
      told_s.add(cut.told_lost_s_at_most);
      if (!cut.problem.empty()) problems.push_back(cut.problem + " (cut after " + std::to_string(cut.recorded_s) + " s)");
    }
    done += count;
    draw_progress(done, cuts);
  }
  std::printf("%zu power cuts (%s) in sessions of %.0f s with 16 channels at 1500 Hz, seed %u\n\n", cuts,
              disk.empty() ? "all that was not synchronised is gone" : (disk + " on a disk with a volatile cache").c_str(), seconds, seed);
  std::printf("| s | min | p50 | p95 | max |\n|---|---|---|---|---|\n");
  recorded_s.print_row("recorded until the cut");
  lost_s.print_row("lost: cut - last time stamp recovered");
  told_s.print_row("lost at most, as the catalogue says");
  return print_problems(problems);
}

int hours(double count) {
  const TemporaryFolder folder;
  const LongRecording long_one = record_hours(count, folder.path());
  const auto bytes = static_cast<double>(long_one.bytes);
  std::printf("%.2f h of 16 channels at 1500 Hz (and a centre of pressure), synthetic, on a virtual time axis\n\n", long_one.hours);
  std::printf("| | |\n|---|---|\n| scans | %llu |\n", static_cast<unsigned long long>(long_one.scans));
  std::printf("| values | %.1f MB |\n| file | %.1f MB: %.2f %% more; the formula says %.1f MB |\n", long_one.data_bytes * 1e-6,
              bytes * 1e-6, 100.0 * (bytes / long_one.data_bytes - 1.0), long_one.expected_bytes * 1e-6);
  std::printf("| index beside it | %.1f MB |\n", static_cast<double>(long_one.index_bytes) * 1e-6);
  std::printf("| recorded in | %.0f s, %.0f times as fast as in life |\n", long_one.took_s, long_one.hours * 3600.0 / long_one.took_s);
  std::printf("| verified in | %.0f s |\n", long_one.verify_s);
  std::printf("| resident memory | %ld kB after a minute of data, %ld kB at the end |\n", long_one.resident_start_kb,
              long_one.resident_end_kb);
  std::vector<std::string> problems;
  if (!long_one.problem.empty()) problems.push_back(long_one.problem);
  if (bytes > 1.03 * long_one.data_bytes) problems.push_back("the file is more than 3 % larger than its values");
  if (long_one.resident_end_kb > long_one.resident_start_kb + 4096) problems.push_back("memory grows");
  return print_problems(problems);
}

}  // namespace
}  // namespace dts::fault

int main(int argc, char** argv) {
  CLI::App app{"What recordings survive, with figures as Markdown tables. Exit status 1: a promise was broken."};
  app.require_subcommand(1);
  std::size_t rounds = 1000, cuts = 50, jobs = 4, every = 1;
  double longest_s = 3.0, seconds = 20.0, count = 8.0;
  std::uint32_t seed = std::random_device()();
  auto* kills = app.add_subcommand("kills", "kill recording daemons, start them again, look at what is left");
  kills->add_option("rounds", rounds, "how many SIGKILLs")->check(CLI::Range(1, 1'000'000))->capture_default_str();
  kills->add_option("--longest", longest_s, "record for at most so many seconds before")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  std::size_t pair_rounds = 20;
  auto* pair = app.add_subcommand("pair", "kill the daemon of one session over two rigs, and let it continue each time");
  pair->add_option("rounds", pair_rounds, "how many SIGKILLs")->check(CLI::Range(1, 1000))->capture_default_str();
  auto* inject = app.add_subcommand("inject", "fail the n-th call to the disk, for every n");
  inject->add_option("--every", every, "only every so many-th n")->check(CLI::Range(1, 1000))->capture_default_str();
  auto* power = app.add_subcommand("power", "take away what was not synchronised, at random moments");
  power->add_option("cuts", cuts, "how many")->check(CLI::Range(1, 1000))->capture_default_str();
  std::string disk;
  power->add_option("--disk", disk, "fail a disk with this file system, of this machine's kernel; needs root")
      ->check(CLI::IsMember({"ext4", "xfs"}));
  power->add_option("--seconds", seconds, "of recording")->check(CLI::Range(1.0, 300.0))->capture_default_str();
  auto* hours = app.add_subcommand("hours", "record hours in accelerated time");
  hours->add_option("hours", count, "how many; 11 GB are 16 hours")->check(CLI::Range(0.02, 100.0))->capture_default_str();
  for (auto* command : {kills, pair, power}) command->add_option("--seed", seed, "of the random moments");
  for (auto* command : {kills, inject})
    command->add_option("--jobs", jobs, "side by side")->check(CLI::Range(1, 64))->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    if (*kills) return dts::fault::kills(rounds, jobs, longest_s, seed);
    if (*pair) return dts::fault::pair_kills(pair_rounds, 2.0, seed);
    if (*inject) return dts::fault::inject_all(jobs, every);
    if (*power) return dts::fault::power(cuts, seconds, disk, seed);
    return dts::fault::hours(count);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
