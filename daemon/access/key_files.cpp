// SPDX-License-Identifier: Apache-2.0
#include "access/key_files.h"

#include <zmq.h>

#include <algorithm>
#include <array>

#include "files/toml_text.h"

namespace dts::access {
namespace {

ClientKey read_client(files::TomlReader& reader) {
  for (const char* key : {"name", "role", "public_key"}) reader.require(key);
  ClientKey client{.name = reader.text("name", ""),
                   .role = role_of_word(reader.choice("role", {"viewer", "operator", "engineer"})).value_or(v1::ROLE_VIEWER),
                   .public_key = reader.text("public_key", ""),
                   .created_utc = reader.short_text("created")};
  if (reader.has("name") && !is_key_name(client.name)) {
    reader.report("name", "a key's name has 1..32 of a-z 0-9 . _ - and is not \"local\"");
  }
  if (reader.has("public_key") && !is_public_key(client.public_key)) {
    reader.report("public_key", "a public key has 40 characters of Z85, as dtsctl key new makes it");
  }
  reader.finish();
  return client;
}

std::vector<ClientKey> read_clients(files::TomlReader& top) {
  std::vector<ClientKey> clients;
  for (files::TomlReader& reader : top.tables("client")) {
    ClientKey client = read_client(reader);
    const auto has_same = [&](auto member) { return std::ranges::find(clients, client.*member, member) != clients.end(); };
    if (has_same(&ClientKey::name)) reader.report("name", "another client is named '" + client.name + "' too");
    if (has_same(&ClientKey::public_key))
      reader.report("public_key",
                    "another client has the same public key: dtsd could not distinguish them; give each client a key of its own");
    clients.push_back(std::move(client));
  }
  if (clients.size() > kMostKeys) top.report("client", "at most " + std::to_string(kMostKeys) + " clients may have keys");
  top.finish();
  return clients;
}

std::optional<std::vector<ClientKey>> clients_of(const std::optional<toml::table>& table, const std::string& name,
                                                 files::Problems& problems) {
  if (!table) return std::nullopt;
  const std::size_t before = problems.size();
  files::TomlReader top(&*table, "", name, problems);
  auto clients = read_clients(top);
  if (problems.size() > before) return std::nullopt;
  return clients;
}

}  // namespace

std::optional<ServerKey> read_server_key(const std::string& file, files::Problems& problems) {
  const auto table = files::parse_toml(file, problems);
  if (!table) return std::nullopt;
  files::TomlReader reader(&*table, "", file, problems);
  ServerKey key{.public_key = reader.text("public_key", ""), .secret_key = reader.text("secret_key", "")};
  reader.finish();
  std::array<char, kKeyCharacters + 1> derived{};
  const bool is_pair = is_public_key(key.secret_key) && zmq_curve_public(derived.data(), key.secret_key.c_str()) == 0 &&
                       key.public_key == std::string_view(derived.data());
  if (is_pair) return key;
  problems.push_back({.file = file,
                      .text = "public_key and secret_key are not a pair; restore the file, or delete it: dtsd then makes a new pair, and "
                              "every client needs the new public key"});
  return std::nullopt;
}

std::string server_key_text(const ServerKey& key) {
  return "# The key pair of this dtsd. Anyone with the secret key can pretend to be this daemon: never copy it to a client.\n"
         "public_key = " +
         files::toml_quoted(key.public_key) + "\nsecret_key = " + files::toml_quoted(key.secret_key) + "\n";
}

std::optional<std::vector<ClientKey>> read_client_keys(const std::string& file, files::Problems& problems) {
  return clients_of(files::parse_toml(file, problems), file, problems);
}

std::optional<std::vector<ClientKey>> parse_client_keys(std::string_view text, const std::string& name, files::Problems& problems) {
  return clients_of(files::parse_toml_text(text, name, problems), name, problems);
}

std::string client_keys_text(const std::vector<ClientKey>& keys) {
  std::string text =
      "# Clients that may connect from other machines. dtsctl key new and dtsctl key revoke write this file. After a change by hand: "
      "systemctl reload dtsd\n";
  for (const ClientKey& key : keys) {
    text += "\n[[client]]\nname = " + files::toml_quoted(key.name) + "\nrole = " + files::toml_quoted(role_word(key.role)) +
            "\npublic_key = " + files::toml_quoted(key.public_key) + "\ncreated = " + files::toml_quoted(key.created_utc) + "\n";
  }
  return text;
}

}  // namespace dts::access
