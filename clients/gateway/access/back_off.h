// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

namespace dts::gateway {

/// Who failed too often waits: nothing for the first failures, then 1 s, 2 s, 4 s ... up to the longest. An hour without a failure
/// forgives. Bounded: of too many keys the one that failed longest ago goes. No clock: told the time.
class BackOff {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostKeys = 4096;
  static constexpr std::chrono::hours kMemory{1};

  BackOff(std::chrono::seconds longest, unsigned free_failures) : longest_(longest), free_failures_(free_failures) {}

  /// How long `key` still has to wait; zero: it may try.
  [[nodiscard]] std::chrono::seconds wait(const std::string& key, Time now) const;
  void add_failure(const std::string& key, Time now);
  void forgive(const std::string& key) { failures_.erase(key); }

  [[nodiscard]] std::size_t size() const noexcept { return failures_.size(); }

 private:
  struct Failures {
    unsigned count = 0;
    Time last;
  };
  void make_room(Time now);

  std::chrono::seconds longest_;
  unsigned free_failures_;
  std::map<std::string, Failures> failures_;
};

}  // namespace dts::gateway
