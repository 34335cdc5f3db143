// SPDX-License-Identifier: Apache-2.0
#include "ctl/key_commands.h"

#include <unistd.h>

#include <array>

#include "cli/table.h"
#include "ctl/ask.h"

namespace dts::ctl {
namespace {

using client::ControlClient;

/// Returns a host name of the daemon's machine for other machines: the host of the present connection or, on the machine itself, its own
/// name.
std::string host_of(const std::string& endpoint) {
  constexpr std::string_view kTcp = "tcp://";
  if (endpoint.starts_with(kTcp)) return endpoint.substr(kTcp.size(), endpoint.rfind(':') - kTcp.size());
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

v1::Role role_of(const std::string& word) {
  if (word == "engineer") return v1::ROLE_ENGINEER;
  return word == "operator" ? v1::ROLE_OPERATOR : v1::ROLE_VIEWER;
}

/// Fails if the daemon does not listen on the network: a key file would have no address.
client::Result<void> check_listens(const v1::ListKeysResponse& keys) {
  if (!keys.control_endpoint().empty()) return {};
  return client::fail(client::ErrorCode::WrongState, "the daemon accepts only this machine: a key has no use yet",
                      "add to its dtsd.toml:  [network]  control = \"tcp://*:5555\"  data = \"tcp://*:5556\"  (one line each), then: "
                      "systemctl restart dtsd dts-relay");
}

}  // namespace

std::string dialled(const std::string& endpoint, const std::string& host) {
  for (const std::string_view every : {"tcp://*:", "tcp://0.0.0.0:", "tcp://[::]:"}) {
    if (endpoint.starts_with(every)) return "tcp://" + host + ":" + endpoint.substr(every.size());
  }
  return endpoint;
}

int run_key_new(const Arguments& arguments, cli::Console& console) {
  const KeyArguments& wishes = arguments.key;
  const std::string file = wishes.out.empty() ? wishes.name + ".key" : wishes.out;
  auto key = client::new_key(wishes.name);
  if (!key) return cli::fail_with(console, key.error());
  auto dts = connect(arguments);
  if (!dts) return cli::fail_with(console, dts.error());
  const auto before = dts->list_keys();  // before the key file is made: if the daemon does not answer, no file remains
  if (!before) return cli::fail_with(console, before.error());
  if (auto listens = check_listens(*before); !listens) return cli::fail_with(console, listens.error());
  const auto where = target(arguments);
  if (!where) return cli::fail_with(console, where.error());
  const std::string host = wishes.host.empty() ? host_of(where->endpoints.control) : wishes.host;
  key->server_public_key = before->server_public_key();
  key->control = dialled(before->control_endpoint(), host);
  key->data = dialled(before->data_endpoint(), host);
  // Writes the file first: a key that only the daemon has must be revoked by hand.
  if (auto written = client::write_new_key(file, *key); !written) return cli::fail_with(console, written.error());
  v1::AddKeyRequest request;
  request.set_name(wishes.name);
  request.set_role(role_of(wishes.role));
  request.set_public_key(key->public_key);
  if (const auto added = dts->add_key(request); !added) {
    // If the answer was lost, the daemon may have the key, so the file is kept.
    if (added.error().code != client::ErrorCode::Unreachable) ::unlink(file.c_str());
    return cli::fail_with(console, added.error());
  }
  if (arguments.is_json) {
    console.out << cli::document({{"name", wishes.name}, {"role", wishes.role}, {"file", file}, {"public_key", key->public_key}});
  } else {
    console.out << file << '\n';
    cli::print_hint(console, "copy it to the other machine, delete it here, then run on the other machine: dtsctl --key " +
                                 cli::printable(file) + " status");
  }
  return cli::kOk;
}

int run_key_list(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [](ControlClient& dts) { return dts.list_keys(); },
      [&](const v1::ListKeysResponse& keys) { print_keys(console, keys); });
}

int run_key_revoke(const Arguments& arguments, cli::Console& console) {
  return ask_and_print(
      arguments, console, [&](ControlClient& dts) { return dts.revoke_key(arguments.key.name); },
      [&](const v1::ListKeysResponse&) {
        console.out << "revoked " << cli::printable(arguments.key.name) << "; its connections are closed\n";
      });
}

void print_keys(cli::Console& console, const v1::ListKeysResponse& keys) {
  cli::Table table({"NAME", "ROLE", "SINCE (UTC)", "PUBLIC KEY"});
  for (const v1::ListKeysResponse::Key& key : keys.keys()) {
    table.add({{key.name()}, {enumerator_word(*v1::Role_descriptor(), key.role())}, {key.created_utc()}, {key.public_key()}});
  }
  table.print(console);
  if (keys.keys_size() == 0) console.out << "no keys: no other machine may connect\n";
  if (auto listens = check_listens(keys); !listens) cli::print_error(console, listens.error().what, listens.error().hint);
}

}  // namespace dts::ctl
