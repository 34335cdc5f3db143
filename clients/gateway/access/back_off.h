// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <map>
#include <string>

namespace dts::gateway {

/// Makes a key wait after too many failures: no wait for the first failures, then 1 s, 2 s, 4 s ... up to the longest wait. An hour without
/// a failure resets the count. Bounded: if there are too many keys, the key whose last failure is oldest is dropped. Has no clock: the
/// caller passes the time.
class BackOff {
 public:
  using Time = std::chrono::steady_clock::time_point;
  static constexpr std::size_t kMostKeys = 4096;
  static constexpr std::chrono::hours kMemory{1};

  BackOff(std::chrono::seconds longest, unsigned free_failures) : longest_(longest), free_failures_(free_failures) {}

  /// Returns how long `key` must still wait; zero: it may try.
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
