// SPDX-License-Identifier: Apache-2.0
// Key files: the daemon's own pair, its clients' list, a client's key. What is accepted is the same when written and read; no problem tells
// a secret.
#include <sys/stat.h>

#include <set>

#include "access/key_files.h"
#include "dts/key.h"
#include "fuzz/fuzz_support.h"

namespace dts::fuzz::keys {
namespace {


void check_clients(const std::string& text) {
  files::Problems problems;
  const auto clients = access::parse_client_keys(text, "clients.toml", problems);
  promise(clients.has_value() == problems.empty(), "keys, or what is wrong with them");
  if (!clients) return;
  promise(clients->size() <= access::kMostKeys, "at most 1000 keys");
  std::set<std::string> names;
  std::set<std::string> keys;
  for (const access::ClientKey& client : *clients) {
    promise(access::is_key_name(client.name) && names.insert(client.name).second, "every name once");
    promise(access::is_public_key(client.public_key) && keys.insert(client.public_key).second, "every key once");
    promise(access::role_word(client.role) != "none", "a key has a role");
  }
  promise(access::parse_client_keys(access::client_keys_text(*clients), "clients.toml", problems) == clients,
          "the keys read are those written");
}

void check_server(const std::string& file) {
  files::Problems problems;
  const auto key = access::read_server_key(file, problems);
  promise(key.has_value() || !problems.empty(), "a key, or what is wrong with it");
  if (!key) return;
  fuzz::put_file(file, access::server_key_text(*key));
  const auto again = access::read_server_key(file, problems);
  promise(again && again->public_key == key->public_key && again->secret_key == key->secret_key, "the pair read is the one written");
}

void check_client(const std::string& file) {
  const auto key = client::read_key(file);
  if (!key) return;
  fuzz::put_file(file, client::key_text(*key));
  const auto again = client::read_key(file);
  promise(again && again->name == key->name && again->public_key == key->public_key && again->secret_key == key->secret_key &&
              again->server_public_key == key->server_public_key && again->control == key->control && again->data == key->data,
          "the key read is the one written");
}

}  // namespace

void try_bytes(const std::uint8_t* bytes, std::size_t size) {
  static const fuzz::Folder folder;
  const std::string text = fuzz::text_of(bytes, size);
  check_clients(text);
  const std::string file = folder.file("key.toml");
  fuzz::put_file(file, text);
  ::chmod(file.c_str(), 0600);
  check_server(file);
  fuzz::put_file(file, text);
  check_client(file);
}

}  // namespace dts::fuzz::keys

DTS_FUZZ_TARGET(keys)
