// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "access/key_store.h"
#include "core/clock.h"
#include "dts/v1/control.pb.h"

namespace dts::ipc {

/// Addresses to which clients with keys connect; empty: the daemon does not listen for them.
struct RemoteAddresses {
  std::string control;
  std::string data;
};

/// Executes commands on the clients' keys: converts requests to calls of the key store, and their results to responses. Thread: control.
class KeyCommands {
 public:
  /// `keys` must outlive this object; nullptr: keys cannot be used, and `problem` is the reason.
  KeyCommands(access::KeyStore* keys, core::Clock& clock, RemoteAddresses addresses, core::Error problem = {})
      : keys_(keys), clock_(clock), addresses_(std::move(addresses)), problem_(std::move(problem)) {}

  [[nodiscard]] dts::v1::Response list() const;
  [[nodiscard]] dts::v1::Response add(const dts::v1::AddKeyRequest& request);
  [[nodiscard]] dts::v1::Response revoke(const dts::v1::RevokeKeyRequest& request);
  /// Returns true if a key was removed or changed since the last call. The caller must then end its connections.
  [[nodiscard]] bool has_lost() noexcept { return keys_ != nullptr && keys_->take_losses(); }

 private:
  access::KeyStore* keys_;
  core::Clock& clock_;
  RemoteAddresses addresses_;
  core::Error problem_;
};

}  // namespace dts::ipc
