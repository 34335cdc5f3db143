// SPDX-License-Identifier: Apache-2.0
// What one scan costs on its way through a queue: SpscRing beside two queues a user could take instead.
// A scan is a time stamp, a sequence number and 16 channels: 80 bytes. Rounds are interleaved, so that a disturbance of
// the machine hits all contenders; the table shows medians, the last row how SpscRing stands to the faster peer.
#include <pthread.h>
#include <readerwriterqueue/readerwriterqueue.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/clock.h"
#include "core/spsc_ring.h"

namespace {

constexpr std::size_t kCapacity = 4096;
constexpr std::size_t kLargestBlock = 64;

struct Scan {
  std::int64_t stamp_ns = 0;
  std::uint64_t sequence = 0;
  std::array<float, 16> channels_v{};
};
static_assert(sizeof(Scan) == 80);

/// The shipped ring through its copying calls.
class CopyingRing {
 public:
  bool push(const Scan& scan) { return ring_.push(scan); }
  bool pop(Scan& out) { return ring_.pop(out); }
  std::size_t push(std::span<const Scan> scans) { return ring_.push(scans); }
  std::size_t pop(std::span<Scan> out) { return ring_.pop(out); }

 private:
  dts::core::SpscRing<Scan> ring_{kCapacity};
};

/// A queue without block calls: a block is a loop.
template <class Queue>
class OneByOne : public Queue {
 public:
  using Queue::pop;
  using Queue::push;
  std::size_t push(std::span<const Scan> scans) {
    std::size_t taken = 0;
    while (taken < scans.size() && push(scans[taken])) ++taken;
    return taken;
  }
  std::size_t pop(std::span<Scan> out) {
    std::size_t taken = 0;
    while (taken < out.size() && pop(out[taken])) ++taken;
    return taken;
  }
};

/// The shipped ring as the sample path uses it: slots filled and read where they lie, one after the other.
class InPlaceSlots {
 public:
  bool push(const Scan& scan) {
    Scan* const slot = ring_.claim();
    if (slot == nullptr) return false;
    *slot = scan;
    ring_.commit();
    return true;
  }
  bool pop(Scan& out) {
    const Scan* const slot = ring_.front();
    if (slot == nullptr) return false;
    out = *slot;
    ring_.release();
    return true;
  }

 private:
  dts::core::SpscRing<Scan> ring_{kCapacity};
};
using InPlaceRing = OneByOne<InPlaceSlots>;

class BoostQueue {
 public:
  bool push(const Scan& scan) { return queue_.push(scan); }
  bool pop(Scan& out) { return queue_.pop(out); }
  std::size_t push(std::span<const Scan> scans) { return queue_.push(scans.data(), scans.size()); }
  std::size_t pop(std::span<Scan> out) { return queue_.pop(out.data(), out.size()); }

 private:
  boost::lockfree::spsc_queue<Scan, boost::lockfree::capacity<kCapacity>> queue_;
};

class MoodycamelSlots {
 public:
  bool push(const Scan& scan) { return queue_.try_enqueue(scan); }
  bool pop(Scan& out) { return queue_.try_dequeue(out); }

 private:
  moodycamel::ReaderWriterQueue<Scan> queue_{kCapacity};
};
using MoodycamelQueue = OneByOne<MoodycamelSlots>;

std::int64_t now_ns() { return dts::core::SystemClock{}.now_ns(); }

void pause_core() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

void pin_to(std::size_t core) noexcept {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(core, &set);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
}

void require(bool is_true, const char* claim) {
  if (is_true) return;
  std::fprintf(stderr, "ring_bench: %s\n", claim);
  std::exit(EXIT_FAILURE);
}

/// Whatever fits of a block: through the call for one element when the block is one.
template <std::size_t kBlock, class Queue>
std::size_t push_some(Queue& queue, std::span<const Scan> scans) {
  if constexpr (kBlock == 1) return queue.push(scans[0]) ? 1 : 0;
  return queue.push(scans);
}

template <std::size_t kBlock, class Queue>
std::size_t pop_some(Queue& queue, std::span<Scan> out) {
  if constexpr (kBlock == 1) return queue.pop(out[0]) ? 1 : 0;
  return queue.pop(out);
}

template <std::size_t kBlock, class Queue>
void push_all(Queue& queue, std::span<const Scan, kBlock> scans) {
  for (std::size_t done = 0; done < kBlock;) {
    const std::size_t taken = push_some<kBlock>(queue, scans.subspan(done));
    if (taken == 0) pause_core();
    done += taken;
  }
}

template <std::size_t kBlock, class Queue>
void pop_all(Queue& queue, std::span<Scan, kBlock> out) {
  for (std::size_t done = 0; done < kBlock;) {
    const std::size_t taken = pop_some<kBlock>(queue, out.subspan(done));
    if (taken == 0) pause_core();
    done += taken;
  }
}

double per_scan_ns(std::int64_t start_ns, std::int64_t end_ns, std::size_t scans) {
  return static_cast<double>(end_ns - start_ns) / static_cast<double>(scans);
}

template <class Queue, std::size_t kBlock>
double one_thread_ns(std::size_t scans) {
  const auto queue = std::make_unique<Queue>();
  std::array<Scan, kBlock> in{};
  std::array<Scan, kBlock> out{};
  const std::int64_t start_ns = now_ns();
  for (std::uint64_t sequence = 0; sequence < scans; sequence += kBlock) {
    in[0].sequence = sequence;
    push_all<kBlock>(*queue, in);
    pop_all<kBlock>(*queue, out);
    require(out[0].sequence == sequence, "order broken in one thread");
  }
  return per_scan_ns(start_ns, now_ns(), scans);
}

template <class Queue, std::size_t kBlock>
void consume(Queue& queue, std::size_t scans) {
  std::array<Scan, kBlock> out{};
  for (std::uint64_t next = 0; next < scans;) {
    const std::size_t taken = pop_some<kBlock>(queue, std::span{out});
    if (taken == 0) {
      pause_core();
      continue;
    }
    require(out[0].sequence == next && out[taken - 1].sequence == next + taken - 1, "order broken between threads");
    next += taken;
  }
}

template <class Queue, std::size_t kBlock>
double two_threads_ns(std::size_t scans) {
  const auto queue = std::make_unique<Queue>();
  std::atomic<bool> is_consumer_ready{false};
  std::int64_t end_ns = 0;
  std::thread consumer([&] {
    pin_to(1);
    is_consumer_ready.store(true, std::memory_order_release);
    consume<Queue, kBlock>(*queue, scans);
    end_ns = now_ns();
  });
  pin_to(0);
  while (!is_consumer_ready.load(std::memory_order_acquire)) std::this_thread::yield();
  std::array<Scan, kBlock> in{};
  const std::int64_t start_ns = now_ns();
  for (std::uint64_t sequence = 0; sequence < scans; sequence += kBlock) {
    for (std::size_t i = 0; i < kBlock; ++i) in[i].sequence = sequence + i;
    push_all<kBlock>(*queue, in);
  }
  consumer.join();
  return per_scan_ns(start_ns, end_ns, scans);
}

/// Half a ping-pong through two queues: how long until the other core holds the scan.
template <class Queue, std::size_t kBlock>
double hand_over_ns(std::size_t round_trips) {
  const auto there = std::make_unique<Queue>();
  const auto back = std::make_unique<Queue>();
  std::atomic<bool> is_echo_ready{false};
  std::thread echo([&] {
    pin_to(1);
    std::array<Scan, kBlock> scan{};
    is_echo_ready.store(true, std::memory_order_release);
    for (std::size_t i = 0; i < round_trips; ++i) {
      pop_all<kBlock>(*there, scan);
      push_all<kBlock>(*back, scan);
    }
  });
  pin_to(0);
  while (!is_echo_ready.load(std::memory_order_acquire)) std::this_thread::yield();
  std::array<Scan, kBlock> scan{};
  const std::int64_t start_ns = now_ns();
  for (std::uint64_t sequence = 0; sequence < round_trips; ++sequence) {
    scan[0].sequence = sequence;
    push_all<kBlock>(*there, scan);
    pop_all<kBlock>(*back, scan);
    require(scan[0].sequence == sequence, "order broken in the hand-over");
  }
  const std::int64_t end_ns = now_ns();
  echo.join();
  return per_scan_ns(start_ns, end_ns, round_trips * 2);
}

constexpr std::array kContenders{"SpscRing", "SpscRing in place", "boost::lockfree::spsc_queue", "moodycamel::ReaderWriterQueue"};
constexpr std::size_t kFirstPeer = 2;

/// One column of the table: the same measurement for each contender, in the order of kContenders.
struct Column {
  const char* title;
  std::size_t scans;
  std::array<double (*)(std::size_t scans), kContenders.size()> measurements;
};

template <std::size_t kBlock>
Column one_thread(const char* title, std::size_t scans) {
  return {title,
          scans,
          {one_thread_ns<CopyingRing, kBlock>, one_thread_ns<InPlaceRing, kBlock>, one_thread_ns<BoostQueue, kBlock>,
           one_thread_ns<MoodycamelQueue, kBlock>}};
}

template <std::size_t kBlock>
Column two_threads(const char* title, std::size_t scans) {
  return {title,
          scans,
          {two_threads_ns<CopyingRing, kBlock>, two_threads_ns<InPlaceRing, kBlock>, two_threads_ns<BoostQueue, kBlock>,
           two_threads_ns<MoodycamelQueue, kBlock>}};
}

Column hand_over(const char* title, std::size_t round_trips) {
  return {title,
          round_trips,
          {hand_over_ns<CopyingRing, 1>, hand_over_ns<InPlaceRing, 1>, hand_over_ns<BoostQueue, 1>, hand_over_ns<MoodycamelQueue, 1>}};
}

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

const char* scheduling_policy() {
  const int policy = sched_getscheduler(0);
  return policy == SCHED_FIFO ? "SCHED_FIFO" : policy == SCHED_RR ? "SCHED_RR" : "default scheduling";
}

using Rounds = std::array<std::vector<double>, kContenders.size()>;

Rounds measure(const Column& column, std::size_t repetitions) {
  Rounds rounds;
  for (std::size_t round = 0; round < repetitions; ++round) {
    for (std::size_t i = 0; i < kContenders.size(); ++i) {
      const std::size_t contender = (i + round) % kContenders.size();  // nobody always runs first
      rounds[contender].push_back(column.measurements[contender](column.scans));
    }
  }
  return rounds;
}

/// Median over the rounds of ours / faster peer, taken within each round.
double ratio_to_faster_peer(const Rounds& rounds, std::size_t ours) {
  const std::size_t peer = median(rounds[kFirstPeer]) <= median(rounds[kFirstPeer + 1]) ? kFirstPeer : kFirstPeer + 1;
  std::vector<double> ratios;
  for (std::size_t i = 0; i < rounds[ours].size(); ++i) ratios.push_back(rounds[ours][i] / rounds[peer][i]);
  return median(std::move(ratios));
}

void print_table(std::span<const Column> columns, std::span<const Rounds> results) {
  std::printf("| ns per scan, median (best) |");
  for (const Column& column : columns) std::printf(" %s |", column.title);
  std::printf("\n|---|");
  for (std::size_t i = 0; i < columns.size(); ++i) std::printf("---|");
  for (std::size_t contender = 0; contender < kContenders.size(); ++contender) {
    std::printf("\n| %s |", kContenders[contender]);
    for (const Rounds& rounds : results) {
      std::printf(" %.1f (%.1f) |", median(rounds[contender]), *std::min_element(rounds[contender].begin(), rounds[contender].end()));
    }
  }
  for (std::size_t ours = 0; ours < kFirstPeer; ++ours) {
    std::printf("\n| **%s / faster peer** |", kContenders[ours]);
    for (const Rounds& rounds : results) std::printf(" **%.2f** |", ratio_to_faster_peer(rounds, ours));
  }
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t repetitions = 15;
  std::size_t scans = 262'144;
  std::size_t round_trips = 10'000;
  CLI::App app{"Cost of one 80-byte scan through SpscRing and two other queues, as a Markdown table"};
  app.add_option("--reps", repetitions, "rounds; the median counts")->check(CLI::Range(1, 10'000))->capture_default_str();
  app.add_option("--scans", scans, "scans per measurement, a multiple of 64")->check(CLI::Range(64, 1 << 28))->capture_default_str();
  app.add_option("--round-trips", round_trips, "ping-pongs per hand-over measurement")
      ->check(CLI::Range(1, 1 << 28))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  scans -= scans % kLargestBlock;  // whole blocks

  std::vector<Column> columns{one_thread<1>("1 thread, x1", scans), one_thread<8>("1 thread, x8", scans),
                              one_thread<64>("1 thread, x64", scans)};
  if (std::thread::hardware_concurrency() >= 2) {
    columns.insert(columns.end(), {two_threads<1>("2 threads, x1", scans), two_threads<8>("2 threads, x8", scans),
                                   two_threads<64>("2 threads, x64", scans), hand_over("hand-over", round_trips)});
  }

  std::printf("%s, %u cores, g++ %s, %s, %zu interleaved rounds of %zu scans, capacity %zu\n\n", cpu_model().c_str(),
              std::thread::hardware_concurrency(), __VERSION__, scheduling_policy(), repetitions, scans, kCapacity);
  std::vector<Rounds> results;
  for (const Column& column : columns) results.push_back(measure(column, repetitions));
  print_table(columns, results);
}
