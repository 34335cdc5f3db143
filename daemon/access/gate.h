// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "access/key_store.h"
#include "access/rate_limit.h"
#include "core/result.h"
#include "dts/v1/control.pb.h"

namespace dts::access {

/// Who sent a command, and what he may do now.
struct Peer {
  std::string who;                       ///< For the audit trail: "local", "key:anna", "revoked key".
  v1::Role role = v1::ROLE_UNSPECIFIED;  ///< Nothing, until somebody gave one.
  bool is_limited = true;                ///< In how much it may send.
};

/// Decides whether a command may run: by the role that the sender's key has now (not when it connected), and by how many it sent lately.
/// Local senders are engineers, and are not limited: the loop takes turns among all. Thread: control.
class Gate {
 public:
  /// `keys` outlives it; nullptr: there are none.
  explicit Gate(const KeyStore* keys);

  /// Behind a local socket is whoever the file system lets in.
  [[nodiscard]] static Peer local() { return {.who = "local", .role = v1::ROLE_ENGINEER, .is_limited = false}; }
  /// `public_key`: "User-Id" as the authenticator gave it.
  [[nodiscard]] Peer remote(const std::string& public_key) const;

  /// Counts a message of this peer, before anybody reads it. LimitExceeded: it is one too many.
  [[nodiscard]] core::Status admit(const Peer& peer, std::int64_t now_ns);
  /// Whether a message that is one too many gets an answer. Counts it: answers have the same limit as commands, a flood gets no more.
  [[nodiscard]] bool is_worth_an_answer(const Peer& peer, std::int64_t now_ns) { return refusals_.take(peer.who, now_ns); }
  /// NotAllowed with the role that is missing.
  [[nodiscard]] static core::Status check(const Peer& peer, const v1::Request& request);
  /// Whether a failed command of this peer goes into the trail that nobody can erase: 20 at once and six a minute do. Counts it.
  [[nodiscard]] bool is_worth_a_note(const Peer& peer, std::int64_t now_ns) { return notes_.take(peer.who, now_ns); }

 private:
  const KeyStore* keys_;
  RateLimit commands_;
  RateLimit refusals_;
  RateLimit notes_;
};

}  // namespace dts::access
