// SPDX-License-Identifier: Apache-2.0
#include "ctl/system_facts.h"

#include <pthread.h>
#include <sched.h>
#include <sys/timex.h>

#include <array>
#include <charconv>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <thread>

#include "core/thread.h"

namespace dts::ctl {
namespace {

/// Tries it instead of reading RLIMIT_RTPRIO, because capabilities and control groups matter too. Uses a separate thread that ends at once.
bool try_fifo() {
  bool is_allowed = false;
  std::thread([&is_allowed] {
    const sched_param lowest{.sched_priority = sched_get_priority_min(SCHED_FIFO)};
    is_allowed = ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &lowest) == 0;
  }).join();
  return is_allowed;
}

/// Reads the kernel's state without changing it: no right is needed.
std::optional<bool> is_clock_synchronised() {
  timex state{};
  if (::adjtimex(&state) < 0) return std::nullopt;
  return (state.status & STA_UNSYNC) == 0;
}

}  // namespace

SystemFacts gather_system_facts() {
  SystemFacts facts;
  facts.may_use_fifo = try_fifo();
  facts.lockable_bytes = core::lockable_bytes();
  std::ifstream file("/sys/devices/system/clocksource/clocksource0/current_clocksource");
  std::getline(file, facts.clock_source);
  facts.is_clock_set = is_clock_synchronised();
  return facts;
}

bool has_listener(const std::string& endpoint) {
  constexpr const char* kListens = "0A";  // TCP_LISTEN
  unsigned port = 0;
  const std::string digits = endpoint.substr(endpoint.rfind(':') + 1);
  std::from_chars(digits.data(), digits.data() + digits.size(), port);
  std::array<char, 16> ending{};
  std::snprintf(ending.data(), ending.size(), ":%04X", port);
  std::ifstream table("/proc/net/tcp");
  if (!table) return true;
  for (std::string line; std::getline(table, line);) {
    std::istringstream fields(line);
    std::string number;
    std::string local;
    std::string remote;
    std::string state;
    fields >> number >> local >> remote >> state;
    if (state == kListens && local.ends_with(ending.data())) return true;
  }
  return false;
}

}  // namespace dts::ctl
