// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_protocol.h"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>

namespace dts::bench {
namespace {

double seconds(const timeval& time) { return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6; }

long resident_pages() {
  std::ifstream file("/proc/self/statm");
  long total = 0;
  long resident = 0;
  file >> total >> resident;
  return resident;
}

}  // namespace

Arguments::Arguments(std::span<char* const> words) {
  for (const std::string_view word : words) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) continue;
    values_.emplace(word.substr(0, equals), word.substr(equals + 1));
  }
}

std::string Arguments::text(std::string_view key, std::string_view fallback) const {
  const auto found = values_.find(key);
  return found == values_.end() ? std::string(fallback) : found->second;
}

double Arguments::number(std::string_view key, double fallback) const {
  const auto found = values_.find(key);
  if (found == values_.end()) return fallback;
  char* end = nullptr;
  const double value = std::strtod(found->second.c_str(), &end);
  return end == found->second.c_str() ? fallback : value;
}

std::uint64_t Arguments::count(std::string_view key, std::uint64_t fallback) const {
  return static_cast<std::uint64_t>(std::max(0.0, number(key, static_cast<double>(fallback))));
}

Plan::Plan(const Arguments& arguments)
    : rate_hz(arguments.number("rate", 1000.0)), chunk(std::max<std::uint64_t>(1, arguments.count("chunk", 1))) {
  const double messages_per_s = rate_hz / static_cast<double>(chunk);
  const double warm_s = arguments.number("warm", 0.5);
  warm_messages = static_cast<std::uint64_t>(warm_s * messages_per_s);
  total_messages = static_cast<std::uint64_t>((warm_s + arguments.number("secs", 5.0)) * messages_per_s);
}

ProcessUse ProcessUse::now(std::int64_t now_ns) {
  rusage use{};
  getrusage(RUSAGE_SELF, &use);
  return {.cpu_s = seconds(use.ru_utime) + seconds(use.ru_stime),
          .context_switches = use.ru_nvcsw + use.ru_nivcsw,
          .at_ns = now_ns,
          .resident_kb = resident_pages() * (sysconf(_SC_PAGESIZE) / 1024)};
}

JsonLine& JsonLine::append(std::string_view key, const std::string& value) {
  body_ += (body_.empty() ? "\"" : ", \"") + std::string(key) + "\": " + value;
  return *this;
}

JsonLine& JsonLine::add(std::string_view key, double value) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.2f", value);
  return append(key, digits.data());
}

JsonLine& JsonLine::add(std::string_view key, std::uint64_t value) { return append(key, std::to_string(value)); }

JsonLine& JsonLine::add(std::string_view key, std::string_view text) { return append(key, "\"" + std::string(text) + "\""); }

void JsonLine::print() const {
  std::printf("{%s}\n", body_.c_str());
  std::fflush(stdout);
}

void say(std::string_view word) {
  std::printf("%.*s\n", static_cast<int>(word.size()), word.data());
  std::fflush(stdout);
}

bool is_told_to_go() {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  return ::poll(&input, 1, 0) > 0;
}

void ConsumerFigures::take(std::uint64_t first_scan, std::size_t scans, std::int64_t stamp_ns, std::int64_t now_ns) {
  if (first_scan < plan_.warm_scans()) {
    next_scan_ = first_scan + scans;
    return;
  }
  if (!has_started_) {
    has_started_ = true;
    begin_ = ProcessUse::now(now_ns);
    next_scan_ = plan_.warm_scans();
  }
  if (first_scan < next_scan_) {
    ++repeated_;
    return;
  }
  lost_ += first_scan - next_scan_;
  next_scan_ = first_scan + scans;
  received_ += scans;
  last_ns_ = now_ns;
  last_latency_ns_ = now_ns - stamp_ns;
  latency_.add_ns(last_latency_ns_);
}

JsonLine ConsumerFigures::report(std::string_view peer) {
  const ProcessUse end = ProcessUse::now(last_ns_);
  const double wall_s = std::max(1e-9, static_cast<double>(last_ns_ - begin_.at_ns) * 1e-9);
  const std::uint64_t missing = is_done() ? 0 : plan_.total_scans() - next_scan_;
  latency_.sort();
  JsonLine line;
  line.add("role", std::string_view("cons")).add("peer", peer).add("rate", plan_.rate_hz).add("chunk", std::uint64_t{plan_.chunk});
  line.add("got", received_).add("lost", lost_ + missing).add("dup", repeated_).add("per_s", static_cast<double>(received_) / wall_s);
  line.add("last", static_cast<double>(last_latency_ns_) * 1e-3).add("min", latency_.us(0.0)).add("p50", latency_.us(0.5));
  line.add("p90", latency_.us(0.9)).add("p99", latency_.us(0.99)).add("p999", latency_.us(0.999)).add("max", latency_.us(1.0));
  line.add("cpu_pct", 100.0 * (end.cpu_s - begin_.cpu_s) / wall_s);
  const auto messages = static_cast<double>(std::max<std::size_t>(1, latency_.size()));
  line.add("cs_per_msg", static_cast<double>(end.context_switches - begin_.context_switches) / messages);
  return line.add("rss", static_cast<std::uint64_t>(end.resident_kb));
}

}  // namespace dts::bench
