// SPDX-License-Identifier: Apache-2.0
#include "bench/process_use.h"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/clock.h"

namespace dts::bench {
namespace {

/// utime + stime: fields 14 and 15 of proc(5) stat; the name in field 2 may contain anything but the last ')'.
double stat_cpu_s(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t end_of_name = line.rfind(')');
  if (end_of_name == std::string::npos) return 0.0;
  std::istringstream fields(line.substr(end_of_name + 1));
  std::string skipped;
  for (int field = 3; field < 14; ++field) fields >> skipped;
  double utime = 0.0;
  double stime = 0.0;
  fields >> utime >> stime;
  return (utime + stime) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::string first_line(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

std::uint64_t switches(const std::filesystem::path& status) {
  std::ifstream file(status);
  std::uint64_t sum = 0;
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(':');
    if (line.find("ctxt_switches") != std::string::npos && colon != std::string::npos) sum += std::stoull(line.substr(colon + 1));
  }
  return sum;
}

}  // namespace

ObservedUse observe(pid_t pid) {
  ObservedUse use{.cpu_s = stat_cpu_s(pid), .at_ns = core::SystemClock{}.now_ns()};
  std::error_code gone;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task", gone)) {
    const std::string on_cpu_ns = first_line(thread.path() / "schedstat");
    if (!on_cpu_ns.empty()) use.thread_cpu_s[first_line(thread.path() / "comm")] += std::stod(on_cpu_ns) * 1e-9;
    use.context_switches += switches(thread.path() / "status");
  }
  return use;
}

UseRate between(const ObservedUse& first, const ObservedUse& last) {
  const double seconds = static_cast<double>(last.at_ns - first.at_ns) * 1e-9;
  UseRate rate{.cpu_percent = 100.0 * (last.cpu_s - first.cpu_s) / seconds};
  for (const auto& [name, cpu_s] : last.thread_cpu_s) {
    const auto before = first.thread_cpu_s.find(name);
    rate.thread_percent[name] = 100.0 * (cpu_s - (before == first.thread_cpu_s.end() ? 0.0 : before->second)) / seconds;
    rate.threads_percent += rate.thread_percent[name];
  }
  rate.switches_per_s = static_cast<double>(last.context_switches - first.context_switches) / seconds;
  return rate;
}

}  // namespace dts::bench
