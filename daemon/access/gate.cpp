// SPDX-License-Identifier: Apache-2.0
#include "access/gate.h"

#include "dts/wire/options.h"

namespace dts::access {
namespace {

// A fast person sends ten commands a second, a dashboard two. A script that needs more must subscribe to a stream.
constexpr double kCommandsPerSecond = 50.0;
constexpr double kCommandBurst = 100.0;
constexpr double kNotesPerSecond = 0.1;
constexpr double kNoteBurst = 20.0;

}  // namespace

Gate::Gate(const KeyStore* keys)
    : keys_(keys),
      commands_(kCommandsPerSecond, kCommandBurst),
      refusals_(kCommandsPerSecond, kCommandBurst),
      notes_(kNotesPerSecond, kNoteBurst) {}

Peer Gate::remote(const std::string& public_key) const {
  const auto key = keys_ == nullptr ? std::nullopt : keys_->find_by_public_key(public_key);
  return key ? Peer{.who = "key:" + key->name, .role = key->role} : Peer{.who = "revoked key"};
}

core::Status Gate::admit(const Peer& peer, std::int64_t now_ns) {
  if (!peer.is_limited || commands_.take(peer.who, now_ns)) return {};
  return core::fail(core::ErrorCode::LimitExceeded, "more than 50 commands per second from " + peer.who,
                    "subscribe to dtsd/status instead of repeating the command");
}

core::Status Gate::check(const Peer& peer, const v1::Request& request) {
  const v1::Role needed = wire::rules_of(request).role();
  // A request without a known command changes nothing. The handler answers it with an error.
  if (request.command_case() == v1::Request::COMMAND_NOT_SET) return {};
  if (request.has_note_login() && peer.is_limited) {
    return core::fail(core::ErrorCode::NotAllowed, "only a gateway on the machine of dtsd may enter a login in the audit trail");
  }
  if (needed != v1::ROLE_UNSPECIFIED && peer.role >= needed) return {};
  return core::fail(
      core::ErrorCode::NotAllowed,
      "this command needs the role " + std::string(role_word(needed)) + "; " + peer.who + " has " + std::string(role_word(peer.role)),
      "ask an engineer for a key with this role: dtsctl key new NAME --role " + std::string(role_word(needed)));
}

}  // namespace dts::access
