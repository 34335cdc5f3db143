// SPDX-License-Identifier: Apache-2.0
#include "access/key_store.h"

#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "core/join.h"
#include "files/whole_file.h"

namespace dts::access {
namespace {

constexpr mode_t kFolderMode = 0700;
constexpr mode_t kFileMode = 0600;

core::Status prepare_folder(const std::string& directory) {
  if (::mkdir(directory.c_str(), kFolderMode) != 0 && errno != EEXIST)
    return core::fail_errno(errno, "key folder " + directory + " cannot be created");
  struct stat found {};
  if (::lstat(directory.c_str(), &found) != 0) return core::fail_errno(errno, "key folder " + directory);
  if (!S_ISDIR(found.st_mode)) return core::fail(core::ErrorCode::Failed, "key folder " + directory + " is not a folder");
  if (found.st_uid != ::geteuid()) {
    return core::fail(core::ErrorCode::NotAllowed, "key folder " + directory + " belongs to another user",
                      "change its owner with chown to the user that runs dtsd");
  }
  if ((found.st_mode & 0077U) != 0) {
    return core::fail(core::ErrorCode::NotAllowed, "key folder " + directory + " is accessible to other users", "chmod 0700 " + directory);
  }
  return {};
}

/// Returns true only if the file certainly does not exist: after an error of the disk, existing keys must not be replaced.
bool is_absent(const std::string& file) {
  struct stat found {};
  return ::lstat(file.c_str(), &found) != 0 && errno == ENOENT;
}

core::Error first_of(const files::Problems& problems) {
  return {core::ErrorCode::InvalidArgument, core::join(problems, "; ", files::to_string),
          "correct the file; until then a running daemon keeps its present keys"};
}

std::string z85_of(std::span<const std::uint8_t> key) {
  std::array<char, kKeyCharacters + 1> text{};
  if (key.size() != 32 || zmq_z85_encode(text.data(), key.data(), key.size()) == nullptr) return {};
  return text.data();
}

template <class Member>
std::optional<ClientKey> found(const std::vector<ClientKey>& keys, const std::string& wanted, Member member) {
  const auto at = std::ranges::find(keys, wanted, member);
  return at == keys.end() ? std::nullopt : std::optional(*at);
}

}  // namespace

core::Result<std::unique_ptr<KeyStore>> KeyStore::open(const std::string& directory) {
  DTS_TRY(prepare_folder(directory));
  std::unique_ptr<KeyStore> store(new KeyStore(directory));
  DTS_TRY(store->load_server());
  DTS_TRY_ASSIGN(store->keys_, store->read());
  return store;
}

core::Status KeyStore::load_server() {
  if (!is_absent(server_file())) {
    files::Problems problems;
    auto key = read_server_key(server_file(), problems);
    if (!key) return tl::make_unexpected(first_of(problems));
    server_ = std::move(*key);
    return {};
  }
  std::array<char, kKeyCharacters + 1> public_key{};
  std::array<char, kKeyCharacters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return core::fail(core::ErrorCode::Unsupported, "libzmq was built without CURVE", "use Debian's libzmq5");
  }
  server_ = {.public_key = public_key.data(), .secret_key = secret_key.data()};
  return files::write_whole_file(server_file(), server_key_text(server_), kFileMode);
}

core::Result<std::vector<ClientKey>> KeyStore::read() const {
  if (is_absent(client_file())) return std::vector<ClientKey>{};
  files::Problems problems;
  auto keys = read_client_keys(client_file(), problems);
  if (!keys) return tl::make_unexpected(first_of(problems));
  return std::move(*keys);
}

core::Status KeyStore::write(std::vector<ClientKey> keys) {
  DTS_TRY(files::write_whole_file(client_file(), client_keys_text(keys), kFileMode));
  replace(std::move(keys));
  return {};
}

void KeyStore::replace(std::vector<ClientKey> keys) {
  const std::lock_guard lock(mutex_);
  const bool has_less = std::ranges::any_of(keys_, [&](const ClientKey& key) {
    const auto now = found(keys, key.public_key, &ClientKey::public_key);
    return !now || now->name != key.name || now->role != key.role;
  });
  keys_ = std::move(keys);
  if (has_less) has_losses_ = true;
}

core::Status KeyStore::add(const ClientKey& key) {
  if (!is_key_name(key.name)) {
    return core::fail(core::ErrorCode::InvalidArgument, "'" + key.name + "' is not a valid name of a key",
                      "use 1 to 32 of the characters a-z 0-9 . _ -, but not \"local\"");
  }
  if (!is_public_key(key.public_key))
    return core::fail(core::ErrorCode::InvalidArgument, "the public key is not valid", "make a new pair: dtsctl key new");
  if (role_word(key.role) == "none")
    return core::fail(core::ErrorCode::InvalidArgument, "the key has no role", "choose a role: viewer, operator or engineer");
  const std::lock_guard change(change_mutex_);
  DTS_TRY_ASSIGN(auto all, read());
  if (found(all, key.name, &ClientKey::name)) {
    return core::fail(core::ErrorCode::WrongState, "a key named '" + key.name + "' exists already",
                      "revoke it first: dtsctl key revoke " + key.name);
  }
  if (found(all, key.public_key, &ClientKey::public_key))
    return core::fail(core::ErrorCode::WrongState, "another client has this public key already");
  if (all.size() == kMostKeys)
    return core::fail(core::ErrorCode::LimitExceeded, "there are 1000 keys already",
                      "revoke keys that are no longer needed; dtsctl key list shows all of them with their dates");
  all.push_back(key);
  return write(std::move(all));
}

core::Status KeyStore::revoke(const std::string& name) {
  const std::lock_guard change(change_mutex_);
  DTS_TRY_ASSIGN(auto all, read());
  if (std::erase_if(all, [&](const ClientKey& key) { return key.name == name; }) == 0) {
    return core::fail(core::ErrorCode::NotFound, "there is no key '" + name + "'", "list the keys: dtsctl key list");
  }
  return write(std::move(all));
}

core::Status KeyStore::reload() {
  const std::lock_guard change(change_mutex_);
  DTS_TRY_ASSIGN(auto fresh, read());
  replace(std::move(fresh));
  return {};
}

std::vector<ClientKey> KeyStore::keys() const {
  const std::lock_guard lock(mutex_);
  return keys_;
}

std::optional<ClientKey> KeyStore::find_by_key(std::span<const std::uint8_t> key) const { return find_by_public_key(z85_of(key)); }

std::optional<ClientKey> KeyStore::find_by_public_key(const std::string& text) const {
  const std::lock_guard lock(mutex_);
  return found(keys_, text, &ClientKey::public_key);
}

}  // namespace dts::access
