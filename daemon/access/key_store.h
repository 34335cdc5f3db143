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

/// The keys of a daemon and their folder, with server.toml (created if missing) and clients.toml. Only the owner may read the folder and
/// both files. Thread: any; a lookup never waits for a file.
class KeyStore {
 public:
  /// Opens the folder, or creates it. Fails if this user cannot create or use the folder, or if a file is damaged. Never replaces a damaged
  /// file.
  [[nodiscard]] static core::Result<std::unique_ptr<KeyStore>> open(const std::string& directory);

  /// Adds a key to the file, which it reads again first because a person may have edited it. Fails with WrongState if the name or the key
  /// exists, with InvalidArgument if a field is wrong, and with LimitExceeded if there are 1000 keys.
  [[nodiscard]] core::Status add(const ClientKey& key);
  /// Removes a key from the file, which it reads again first. Fails with NotFound if there is no key with this name.
  [[nodiscard]] core::Status revoke(const std::string& name);
  /// Reads clients.toml again. If it fails, keeps the previous keys and returns every problem in one text.
  [[nodiscard]] core::Status reload();
  /// Returns true if a key was removed, renamed or given another role since the last call. The caller must then end its connections.
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
