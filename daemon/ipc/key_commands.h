// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "access/key_store.h"
#include "core/clock.h"
#include "dts/v1/control.pb.h"
#include "settings/shared_settings.h"

namespace dts::ipc {

/// Executes commands on the clients' keys: converts requests to calls of the key store, and their results to responses. Thread: control.
class KeyCommands {
 public:
  /// `keys` must outlive this object; nullptr: keys cannot be used, and `problem` is the reason. `network`: where dts-relay listens.
  KeyCommands(access::KeyStore* keys, core::Clock& clock, std::optional<settings::RemoteEndpoints> network, core::Error problem = {})
      : keys_(keys), clock_(clock), network_(std::move(network)), problem_(std::move(problem)) {}

  [[nodiscard]] dts::v1::Response list() const;
  [[nodiscard]] dts::v1::Response add(const dts::v1::AddKeyRequest& request);
  [[nodiscard]] dts::v1::Response revoke(const dts::v1::RevokeKeyRequest& request);
  [[nodiscard]] bool has_network() const noexcept { return network_.has_value(); }

 private:
  access::KeyStore* keys_;
  core::Clock& clock_;
  std::optional<settings::RemoteEndpoints> network_;
  core::Error problem_;
};

}  // namespace dts::ipc
