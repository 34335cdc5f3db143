// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "access/key_store.h"
#include "core/clock.h"
#include "dts/v1/control.pb.h"

namespace dts::ipc {

/// Where clients with keys connect; empty: nothing listens for them.
struct RemoteAddresses {
  std::string control;
  std::string data;
};

/// Commands on the keys of clients: wire messages in, calls on the store, wire messages out. Thread: control.
class KeyCommands {
 public:
  /// `keys` outlives it; nullptr: they cannot be used, as `problem` says.
  KeyCommands(access::KeyStore* keys, core::Clock& clock, RemoteAddresses addresses, core::Error problem = {})
      : keys_(keys), clock_(clock), addresses_(std::move(addresses)), problem_(std::move(problem)) {}

  [[nodiscard]] dts::v1::Response list() const;
  [[nodiscard]] dts::v1::Response add(const dts::v1::AddKeyRequest& request);
  [[nodiscard]] dts::v1::Response revoke(const dts::v1::RevokeKeyRequest& request);
  /// Whether, since the last call, a key has gone or changed: ending its connections is the server's part.
  [[nodiscard]] bool has_lost() noexcept { return keys_ != nullptr && keys_->take_losses(); }

 private:
  access::KeyStore* keys_;
  core::Clock& clock_;
  RemoteAddresses addresses_;
  core::Error problem_;
};

}  // namespace dts::ipc
