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

/// The sender of a command, and its current rights.
struct Peer {
  std::string who;                       ///< For the audit trail: "local", "key:anna", "revoked key".
  v1::Role role = v1::ROLE_UNSPECIFIED;  ///< Unspecified: no rights.
  bool is_remote = true;
};

/// Decides whether a command may run: by the current role of the sender's key, not its role at connection time. Local senders have the role
/// engineer. Thread: control.
class Gate {
 public:
  /// `keys` must outlive this object; nullptr: there are no keys.
  explicit Gate(const KeyStore* keys);

  /// Returns the sender behind a local socket. The file system's permissions decide who can use the socket.
  [[nodiscard]] static Peer local() { return {.who = "local", .role = v1::ROLE_ENGINEER, .is_remote = false}; }
  /// Returns the sender with this key.
  [[nodiscard]] Peer remote(const std::string& public_key) const;

  /// Fails with NotAllowed, naming the required role, if the peer's role does not allow the request.
  [[nodiscard]] static core::Status check(const Peer& peer, const v1::Request& request);
  /// Returns true if the audit trail records a failed command of this peer: at most 20 at once and six a minute, because nobody can erase
  /// the trail. Counts it.
  [[nodiscard]] bool is_worth_a_note(const Peer& peer, std::int64_t now_ns) { return notes_.take(peer.who, now_ns); }

 private:
  const KeyStore* keys_;
  RateLimit notes_;
};

}  // namespace dts::access
