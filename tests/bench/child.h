// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>

#include "bench/percentiles.h"

namespace dts::bench {

/// What a child process of the benchmark measured. Trivially copyable: it travels through a pipe.
struct Measured {
  double p50_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double max_us = 0.0;
  std::uint64_t samples = 0;
  // Subscribers only; scans of the counted stream.
  std::uint64_t received = 0;
  std::uint64_t expected = 0;   ///< By the host times of the first and last scan.
  std::uint64_t told_lost = 0;  ///< On the way to this subscriber, as libdts says.
  std::uint64_t gap_scans = 0;  ///< Before the pipeline, as the gap events say.
  double cpu_percent = 0.0;     ///< Of one core; `run_devices` only.

  void set(Percentiles& latency);
};

/// A forked process that measures something for a while. Fork it while this process has one thread only.
class Child {
 public:
  /// The child becomes SCHED_FIFO of `fifo_priority` (0: not), runs `work` and sends what that returns. `work` calls the
  /// function given to it once it is set up.
  template <class Work>
  Child(int fifo_priority, Work work) : Child() {
    if (pid_ == 0) serve(fifo_priority, [&] { return work([this] { announce(); }); });
  }
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  Child(Child&& other) noexcept;
  Child& operator=(Child&&) = delete;

  /// False when the child ended before it was set up.
  [[nodiscard]] bool wait_until_ready() const;
  /// Waits for its end.
  [[nodiscard]] Measured result();

 private:
  Child();
  void announce() const;
  template <class Work>
  [[noreturn]] void serve(int fifo_priority, Work work) {
    become_realtime(fifo_priority);
    finish(work());
  }
  static void become_realtime(int fifo_priority);
  [[noreturn]] void finish(const Measured& measured) const;

  pid_t pid_ = -1;
  int read_fd_ = -1;
  int write_fd_ = -1;
};

/// Whether this user may use SCHED_FIFO of that priority.
[[nodiscard]] bool may_use_fifo(int priority);

/// Receives everything of rig "floor" for `seconds` after the first block; counts stream "cop".
[[nodiscard]] Child subscribe(const std::string& endpoint, double seconds, int fifo_priority);
/// Reads the devices of all rigs in a configuration file of the daemon for `seconds`, in real time, and does nothing with their scans.
[[nodiscard]] Child run_devices(const std::string& config_file, double seconds);
/// How late an absolute-deadline sleep wakes.
[[nodiscard]] Child tick(double rate_hz, double seconds, int fifo_priority);
/// Publishes 16-channel protobuf messages over plain libzmq, one per scan, for `seconds`.
[[nodiscard]] Child publish_plain(const std::string& endpoint, double rate_hz, double seconds, int fifo_priority);
/// Receives them: latency from the instant a message was due to its decoded form.
[[nodiscard]] Child receive_plain(const std::string& endpoint, double seconds, int fifo_priority);

}  // namespace dts::bench
