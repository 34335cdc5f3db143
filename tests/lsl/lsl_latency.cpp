// SPDX-License-Identifier: Apache-2.0
// Latency from the instant of a scan to its value at an inlet of liblsl: through dtsd and dts-lsl, and beside it, in the same seconds, from
// a program that has nothing but an outlet of liblsl. Prints a Markdown table. Argument: seconds (default 30).
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/thread.h"
#include "lsl/lsl_peer.h"
#include "lsl/lsl_system.h"
#include "lsl/outlet.h"

namespace dts::test {
namespace {

constexpr double kRateHz = 1500.0;
constexpr int kChannels = 16;
constexpr std::size_t kWarmSamples = 1500;

/// Pulls samples one at a time, and notes how old each is when the inlet returns it.
std::vector<double> ages_us(Inlet& inlet, double seconds) {
  std::vector<double> ages;
  const std::int64_t end_ns = monotonic_ns() + static_cast<std::int64_t>(seconds * 1e9);
  std::size_t seen = 0;
  while (monotonic_ns() < end_ns) {
    Inlet::Samples samples;
    if (inlet.pull(samples, 1.0) == 0) continue;
    const double now_s = lsl::lsl_time_s(monotonic_ns());
    for (const double stamp_s : samples.stamps_s) {
      if (++seen > kWarmSamples) ages.push_back((now_s - stamp_s) * 1e6);
    }
  }
  std::ranges::sort(ages);
  return ages;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0.0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

/// Sends as a device driver with an outlet of its own does: one sample at each tick, stamped with the time of the tick.
void send_own(PeerOutlet& outlet, const std::atomic<bool>& is_over) {
  static_cast<void>(core::configure_this_thread("own-outlet", {}));
  core::SystemClock clock;
  const std::vector<float> values(kChannels, 1.0F);
  const std::int64_t begin_ns = clock.now_ns();
  for (std::int64_t tick = 1; !is_over; ++tick) {
    const std::int64_t due_ns = begin_ns + static_cast<std::int64_t>(static_cast<double>(tick) * 1e9 / kRateHz);
    clock.sleep_until_ns(due_ns);
    outlet.push(values, lsl::lsl_time_s(due_ns));
  }
}

int measure(double seconds) {
  isolate_lsl();
  DaemonProcess daemon({.device = "sim:floor?seed=7&extra=12", .acquire = "rate_hz = 1500.0\nlow_latency = true"});
  const LslProcess bridge(daemon);
  if (!daemon.is_ready() || !bridge.is_ready()) {
    std::fprintf(stderr, "%s\n%s\n", daemon.log().c_str(), bridge.log().c_str());
    return 1;
  }
  PeerOutlet own("own", kChannels, kRateHz, "own");
  std::atomic<bool> is_over = false;
  std::thread sender([&] { send_own(own, is_over); });
  Inlet through("floor/aux");
  Inlet direct("own");
  std::vector<double> of_direct;
  std::thread reader([&] { of_direct = ages_us(direct, seconds); });
  const std::vector<double> of_through = ages_us(through, seconds);
  reader.join();
  is_over = true;
  sender.join();

  std::printf("| inlet fed by | channels | samples | p50 (us) | p99 (us) |\n|---|---|---|---|---|\n");
  std::printf("| dtsd and dts-lsl (floor/aux) | %zu | %zu | %.0f | %.0f |\n", through.channels(), of_through.size(),
              quantile(of_through, 0.5), quantile(of_through, 0.99));
  std::printf("| liblsl's own outlet | %d | %zu | %.0f | %.0f |\n", kChannels, of_direct.size(), quantile(of_direct, 0.5),
              quantile(of_direct, 0.99));
  std::printf("\np50 ratio: %.2f, p99 ratio: %.2f\n", quantile(of_through, 0.5) / std::max(1e-3, quantile(of_direct, 0.5)),
              quantile(of_through, 0.99) / std::max(1e-3, quantile(of_direct, 0.99)));
  return 0;
}

}  // namespace
}  // namespace dts::test

int main(int count, char** words) {
  if (dts::test::liblsl_file().empty()) {
    std::fprintf(stderr, "lsl_latency: no liblsl: install npm, or configure with -DDTS_LIBLSL=FILE\n");
    return 1;
  }
  return dts::test::measure(count > 1 ? std::atof(words[1]) : 30.0);
}
