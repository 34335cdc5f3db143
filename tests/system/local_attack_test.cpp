// SPDX-License-Identifier: Apache-2.0
// Local clients that mean the daemon ill. Meanwhile a subscriber of libdts and one of libzmq must miss nothing, the daemon's memory must
// not grow, and an operator must be able to act. DTS_ATTACK_SECONDS is the length of each attack, 1 s by default.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "support/machine_lateness.h"
#include "support/sanitized.h"
#include "system/daemon_process.h"

namespace dts::test {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr long kMostKb = 4 * 1024;
constexpr steady_clock::duration kLongestSilence = std::chrono::seconds(2);  // a block takes 10 ms; much more than the daemon may cause

std::string attack_seconds() {
  const char* wanted = std::getenv("DTS_ATTACK_SECONDS");
  return wanted != nullptr ? wanted : "1";
}

double in_ms(steady_clock::duration time) { return std::chrono::duration<double, std::milli>(time).count(); }

/// What a subscriber noticed.
struct Seen {
  std::uint64_t blocks = 0;
  std::uint64_t lost = 0;  ///< Scans (libdts) or blocks (libzmq).
  std::uint64_t faults = 0;
  steady_clock::duration silence{};
  std::optional<steady_clock::time_point> last{};

  void note_block() {
    const auto now = steady_clock::now();
    if (last) silence = std::max(silence, now - *last);
    last = now;
    ++blocks;
  }
};

class LocalAttackTest : public ::testing::Test {
 protected:
  explicit LocalAttackTest(const std::string& acquire = "") : daemon_({.acquire = acquire}) {}
  void SetUp() override {
    ASSERT_TRUE(daemon_.is_ready());
    operator_.emplace(daemon_.control());
    ASSERT_TRUE(eventually([&] { return operator_->status()->rigs(0).scans_total() > 0; }));
    std::ignore = marks(milliseconds(300));  // the first ones open the audit trail
  }

  struct Marks {
    double median_ms = 0.0;
    double slowest_ms = 0.0;
    long most_kb = 0;
  };
  /// Marks one after the other, each of which must be answered.
  Marks marks(steady_clock::duration length, const std::stop_token& stop = {}) {
    Marks result;
    std::vector<double> times_ms;
    for (const auto end = steady_clock::now() + length; steady_clock::now() < end && !stop.stop_requested();) {
      const auto asked = steady_clock::now();
      EXPECT_TRUE(operator_->mark("still here", "floor"));
      times_ms.push_back(in_ms(steady_clock::now() - asked));
      result.most_kb = std::max(result.most_kb, resident_kb(daemon_.pid()));
      std::this_thread::sleep_for(milliseconds(10));
    }
    std::ranges::sort(times_ms);
    if (times_ms.empty()) return result;
    result.median_ms = times_ms[times_ms.size() / 2];
    result.slowest_ms = times_ms.back();
    return result;
  }

  static Seen read(client::Subscriber& subscriber, const std::stop_token& stop) {
    Seen seen;
    while (!stop.stop_requested()) {
      const auto message = subscriber.receive(milliseconds(20)).value();
      const auto* block = message ? std::get_if<client::Block>(&*message) : nullptr;
      if (block == nullptr) continue;
      seen.note_block();
      seen.lost += block->lost_scans;
    }
    seen.faults = subscriber.statistics().interruptions + subscriber.statistics().malformed;
    return seen;
  }
  static Seen read(zmq::socket_t& socket, const std::stop_token& stop) {
    Seen seen;
    std::optional<std::uint64_t> sequence;
    while (!stop.stop_requested()) {
      std::array<zmq::message_t, 2> parts;
      if (!socket.recv(parts[0])) continue;  // a time limit
      const bool is_block = socket.recv(parts[1]).has_value() && parts[0].to_string_view() == "floor/cop" && !parts[1].more();
      v1::StreamBlock block;
      if (!is_block || !block.ParseFromArray(parts[1].data(), static_cast<int>(parts[1].size()))) {
        ++seen.faults;
        continue;
      }
      seen.note_block();
      if (sequence) seen.lost += block.sequence() - *sequence - 1;
      sequence = block.sequence();
    }
    return seen;
  }
  [[nodiscard]] zmq::socket_t zmq_subscriber() {
    zmq::socket_t socket(context_, zmq::socket_type::sub);
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::rcvtimeo, 20);
    socket.set(zmq::sockopt::subscribe, "floor/cop");
    socket.connect(daemon_.data_endpoint());
    return socket;
  }

  /// Runs the attack in some processes at once.
  void under(const std::string& attack, int processes = 1, long most_kb = kMostKb) {
    const Marks quiet = marks(milliseconds(300));
    const long before_kb = resident_kb(daemon_.pid());
    const MachineLateness lateness;
    Seen of_libdts;
    Seen of_libzmq;
    std::jthread libdts(
        [&, subscriber = daemon_.subscribe({"floor/cop"})](const std::stop_token& stop) mutable { of_libdts = read(subscriber, stop); });
    std::jthread libzmq([&, socket = zmq_subscriber()](const std::stop_token& stop) mutable { of_libzmq = read(socket, stop); });
    Marks attacked;
    std::jthread mate([&](const std::stop_token& stop) { attacked = marks(kPatience, stop); });
    std::vector<Finished> finished(static_cast<std::size_t>(processes));
    {
      std::vector<std::jthread> attackers;
      for (Finished& one : finished) {
        attackers.emplace_back([&] {
          one = run_program({DTS_LOCAL_ATTACKER, (daemon_.directory() / "data.sock").string(), attack, attack_seconds()});
        });
      }
    }
    for (std::jthread* thread : {&mate, &libdts, &libzmq}) {
      thread->request_stop();
      thread->join();
    }
    for (const Finished& one : finished) EXPECT_EQ(one.status, 0) << one.err;
    const long grown_kb = std::max(attacked.most_kb, resident_kb(daemon_.pid())) - before_kb;
    std::printf(
        "%s x %d (%.*s each): silence %.0f ms (libdts), %.0f ms (libzmq), machine late by %.0f ms; lost %llu and %llu; memory +%ld kB; "
        "mark %.1f ms, slowest %.1f ms (before: %.1f, %.1f)\n",
        attack.c_str(), processes, static_cast<int>(finished[0].out.size()) - 1, finished[0].out.c_str(), in_ms(of_libdts.silence),
        in_ms(of_libzmq.silence), in_ms(lateness.worst()), static_cast<unsigned long long>(of_libdts.lost),
        static_cast<unsigned long long>(of_libzmq.lost), grown_kb, attacked.median_ms, attacked.slowest_ms, quiet.median_ms,
        quiet.slowest_ms);
    for (const Seen& seen : {of_libdts, of_libzmq}) {
      EXPECT_GT(seen.blocks, 0U);
      EXPECT_EQ(seen.lost, 0U);
      EXPECT_EQ(seen.faults, 0U);
      EXPECT_LT(in_ms(seen.silence), in_ms(kLongestSilence + lateness.worst()));
    }
    EXPECT_EQ(daemon_.control().status()->rigs(0).lost_scans_total(), 0U);
    if (!kIsSanitized) {
      EXPECT_LE(grown_kb, most_kb);
    }
  }

  DaemonProcess daemon_;
  zmq::context_t context_;
  std::optional<client::ControlClient> operator_;
};

/// Fills the queue of a subscriber that does not read within a second.
class FastLocalAttackTest : public LocalAttackTest {
 protected:
  FastLocalAttackTest() : LocalAttackTest("rate_hz = 1500.0\nlow_latency = true") {}
};

TEST_F(LocalAttackTest, Subscriptions) { under("subscriptions"); }
TEST_F(LocalAttackTest, SubscriptionsOf500Bytes) { under("long-subscriptions"); }
TEST_F(LocalAttackTest, SubscriptionsThatChangeAllTheTime) { under("changes", 2); }
/// The bound is that of the prefixes: 64 connections with 256 of them, each with less than 100 bytes of overhead.
TEST_F(LocalAttackTest, AsManySubscriptionsAsAllowed) { under("all-subscriptions", 1, kMostKb + 64 * 256 * 300 / 1024); }
TEST_F(LocalAttackTest, MessagesWithoutEnd) {
  RecordProperty("requirement", "SEC-3");
  under("multi-part");
}
TEST_F(LocalAttackTest, WritesOfOneByte) { under("one-byte", 2); }
TEST_F(LocalAttackTest, ManyConnectionsThatComeAndGo) { under("connections", 4); }
TEST_F(LocalAttackTest, HalfOpenConnections) { under("half-open", 4); }
TEST_F(LocalAttackTest, IdleConnections) { under("idle", 4); }
TEST_F(FastLocalAttackTest, SubscribersThatNeverRead) { under("never-reading"); }
/// The bound is that of the queues: all small ones and all large ones.
TEST_F(FastLocalAttackTest, AllConnectionsNeverRead) { under("never-reading", 4, kMostKb + 256 * 9 + 16 * 352); }
TEST_F(FastLocalAttackTest, SubscribersThatSip) { under("sipping"); }
TEST_F(LocalAttackTest, AllConnectionsRead) { under("reading", 4); }
TEST_F(LocalAttackTest, FramesOf9Exabytes) { under("huge-frames"); }
TEST_F(LocalAttackTest, Noise) { under("noise"); }
TEST_F(LocalAttackTest, NoiseBehindTheHandshake) { under("noise-behind-the-handshake"); }

}  // namespace
}  // namespace dts::test
