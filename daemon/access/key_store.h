// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "access/client_key.h"
#include "access/key_files.h"
#include "core/result.h"

namespace dts::access {

/// The keys of a daemon, and the folder in which they live: server.toml, made when there is none, and clients.toml. The folder and both
/// files are for their owner only. Thread: any; looking up never waits for a file.
class KeyStore {
 public:
  /// Fails when the folder cannot be made or used by this user, or a file is damaged; a damaged one is never replaced.
  [[nodiscard]] static core::Result<std::unique_ptr<KeyStore>> open(const std::string& directory);

  /// Both change what the file says now, which somebody may have edited. WrongState: there is such a name or such a key; InvalidArgument: a field is wrong; LimitExceeded: 1000 keys.
  [[nodiscard]] core::Status add(const ClientKey& key);
  /// NotFound: there is none of that name.
  [[nodiscard]] core::Status revoke(const std::string& name);
  /// Reads clients.toml again. Fails, keeping what it knew, with every problem in one text.
  [[nodiscard]] core::Status reload();
  /// Whether, since the last call, a key that was there has gone or got another name or role: connections that use it must end.
  [[nodiscard]] bool take_losses() noexcept { return has_losses_.exchange(false); }

  [[nodiscard]] std::vector<ClientKey> keys() const;
  /// `key`: the 32 bytes of a public key.
  [[nodiscard]] std::optional<ClientKey> find_by_key(std::span<const std::uint8_t> key) const;
  [[nodiscard]] std::optional<ClientKey> find_by_public_key(const std::string& text) const;
  [[nodiscard]] const ServerKey& server() const noexcept { return server_; }

 private:
  explicit KeyStore(std::string directory) : directory_(std::move(directory)) {}
  [[nodiscard]] core::Status load_server();
  [[nodiscard]] core::Result<std::vector<ClientKey>> read() const;
  [[nodiscard]] core::Status write(std::vector<ClientKey> keys);
  void replace(std::vector<ClientKey> keys);
  [[nodiscard]] std::string server_file() const { return directory_ + "/server.toml"; }
  [[nodiscard]] std::string client_file() const { return directory_ + "/clients.toml"; }

  std::string directory_;
  ServerKey server_;
  std::mutex change_mutex_;  ///< One change of the file at a time.
  mutable std::mutex mutex_;
  std::vector<ClientKey> keys_;
  std::atomic<bool> has_losses_{false};
};

}  // namespace dts::access
