// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "bench/percentiles.h"

namespace dts::bench {

/// Arguments of the form key=value, as the peers' driver gives them. Keys that nobody asks for are ignored: all peers get the same.
class Arguments {
 public:
  explicit Arguments(std::span<char* const> words);

  [[nodiscard]] std::string text(std::string_view key, std::string_view fallback) const;
  /// `fallback` also for what is not a number.
  [[nodiscard]] double number(std::string_view key, double fallback) const;
  [[nodiscard]] std::uint64_t count(std::string_view key, std::uint64_t fallback) const;

 private:
  std::map<std::string, std::string, std::less<>> values_;
};

/// What a run sends: warm-up, then the measured part, in messages of `chunk` scans. Producer and consumer compute it from the
/// same arguments and so agree on when the run is over.
struct Plan {
  double rate_hz = 1000.0;
  std::size_t chunk = 1;
  std::uint64_t warm_messages = 0;
  std::uint64_t total_messages = 0;

  explicit Plan(const Arguments& arguments);
  [[nodiscard]] std::uint64_t warm_scans() const noexcept { return warm_messages * chunk; }
  [[nodiscard]] std::uint64_t total_scans() const noexcept { return total_messages * chunk; }
};

/// What this process has used so far, all its threads together.
struct ProcessUse {
  double cpu_s = 0.0;
  long context_switches = 0;
  std::int64_t at_ns = 0;
  long resident_kb = 0;

  [[nodiscard]] static ProcessUse now(std::int64_t now_ns);
};

/// One line of JSON: what the driver reads.
class JsonLine {
 public:
  JsonLine& add(std::string_view key, double value);
  JsonLine& add(std::string_view key, std::uint64_t value);
  JsonLine& add(std::string_view key, std::string_view text);
  void print() const;

 private:
  JsonLine& append(std::string_view key, const std::string& value);
  std::string body_;
};

/// Tells the driver to go on: "UP" (can be subscribed to) or "READY" (is subscribed).
void say(std::string_view word);
/// True when the driver's line on stdin is there.
[[nodiscard]] bool is_told_to_go();

/// What a consumer saw after the warm-up.
class ConsumerFigures {
 public:
  explicit ConsumerFigures(const Plan& plan) : plan_(plan), latency_(plan.total_messages + 16) {}

  /// `scans` scans from `first_scan` on, the newest stamped `stamp_ns`, in hand at `now_ns`.
  void take(std::uint64_t first_scan, std::size_t scans, std::int64_t stamp_ns, std::int64_t now_ns);
  [[nodiscard]] bool has_started() const noexcept { return has_started_; }
  [[nodiscard]] bool is_done() const noexcept { return next_scan_ >= plan_.total_scans(); }
  /// Fields that every consumer reports.
  [[nodiscard]] JsonLine report(std::string_view peer);

 private:
  Plan plan_;
  Percentiles latency_;
  std::uint64_t next_scan_ = 0;
  std::uint64_t received_ = 0;
  std::uint64_t lost_ = 0;
  std::uint64_t repeated_ = 0;
  std::int64_t last_latency_ns_ = 0;
  std::int64_t last_ns_ = 0;
  bool has_started_ = false;
  ProcessUse begin_;
};

}  // namespace dts::bench
