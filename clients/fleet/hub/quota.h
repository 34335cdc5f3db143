// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>

#include "core/token_bucket.h"
#include "fleet/wire/subjects.h"

namespace dts::fleet::hub {

/// Table [quota] of hub.toml: what each clinic may use of the centre.
struct QuotaFigures {
  std::uint64_t bytes_a_day = 200'000'000'000;   ///< 10 rigs with 16 channels at 1500 Hz, round the clock.
  std::uint64_t staged_bytes = 100'000'000'000;  ///< The sizes of files that are not whole yet.
  double messages_per_s = 100.0;                 ///< Of each matter; see MessageQuota.
  std::uint64_t sessions = 200'000;
  std::uint64_t recordings = 400'000;
  std::uint64_t rows = 50'000'000;  ///< Parts, trials and results of all sessions.
  std::uint64_t erased_sessions = 100'000;
};

/// Limits how often a clinic may send, so that one clinic that floods the centre leaves time for the others. There is a token bucket for
/// each clinic and matter: an upload does not delay heartbeats. A message counts as one, and as one more for each 16 KiB, so that large
/// facts count as what they cost. A chunk counts as a 20th, whatever its size, which `bytes_a_day` limits. Beats have a rate of their own,
/// once a second. Four seconds' worth may come at once. Thread: any.
class MessageQuota {
 public:
  explicit MessageQuota(double messages_per_s) : messages_per_s_(messages_per_s) {}

  /// Returns true, and counts the message, if the hub may handle it now.
  [[nodiscard]] bool take(const std::string& clinic, wire::Matter matter, std::size_t bytes, core::TokenBucket::Time now);
  /// Returns how many messages of each clinic were not handled.
  [[nodiscard]] std::map<std::string, std::uint64_t> slowed() const;

 private:
  struct Clinic {
    std::map<wire::Matter, core::TokenBucket> buckets{};
    std::uint64_t slowed = 0;
  };

  double messages_per_s_;
  mutable std::mutex mutex_;
  std::map<std::string, Clinic> clinics_{};  ///< At most those that nats-server has let in.
};

}  // namespace dts::fleet::hub
