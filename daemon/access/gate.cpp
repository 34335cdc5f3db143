// SPDX-License-Identifier: Apache-2.0
#include "access/gate.h"

#include "dts/wire/options.h"

namespace dts::access {
namespace {

constexpr double kNotesPerSecond = 0.1;
constexpr double kNoteBurst = 20.0;

}  // namespace

Gate::Gate(const KeyStore* keys) : keys_(keys), notes_(kNotesPerSecond, kNoteBurst) {}

Peer Gate::remote(const std::string& public_key) const {
  const auto key = keys_ == nullptr ? std::nullopt : keys_->find_by_public_key(public_key);
  return key ? Peer{.who = "key:" + key->name, .role = key->role} : Peer{.who = "revoked key"};
}

core::Status Gate::check(const Peer& peer, const v1::Request& request) {
  const v1::Role needed = wire::rules_of(request).role();
  // A request without a known command changes nothing. The handler answers it with an error.
  if (request.command_case() == v1::Request::COMMAND_NOT_SET) return {};
  if (request.has_note_login() && peer.is_remote) {
    return core::fail(core::ErrorCode::NotAllowed, "only a gateway on the machine of dtsd may enter a login in the audit trail");
  }
  if (needed != v1::ROLE_UNSPECIFIED && peer.role >= needed) return {};
  return core::fail(
      core::ErrorCode::NotAllowed,
      "this command needs the role " + std::string(role_word(needed)) + "; " + peer.who + " has " + std::string(role_word(peer.role)),
      "ask an engineer for a key with this role: dtsctl key new NAME --role " + std::string(role_word(needed)));
}

}  // namespace dts::access
