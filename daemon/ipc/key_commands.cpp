// SPDX-License-Identifier: Apache-2.0
#include "ipc/key_commands.h"

#include "core/utc_text.h"
#include "ipc/command_handler.h"

namespace dts::ipc {

dts::v1::Response KeyCommands::list() const {
  if (keys_ == nullptr) return error_response(problem_);
  dts::v1::Response response;
  auto& out = *response.mutable_keys();
  for (const access::ClientKey& key : keys_->keys()) {
    auto& info = *out.add_keys();
    info.set_name(key.name);
    info.set_role(key.role);
    info.set_public_key(key.public_key);
    info.set_created_utc(key.created_utc);
  }
  out.set_server_public_key(keys_->server().public_key);
  if (network_) {
    out.set_control_endpoint(network_->control);
    out.set_data_endpoint(network_->data);
  }
  return response;
}

dts::v1::Response KeyCommands::add(const dts::v1::AddKeyRequest& request) {
  if (keys_ == nullptr) return error_response(problem_);
  const auto added = keys_->add({.name = request.name(),
                                 .role = request.role(),
                                 .public_key = request.public_key(),
                                 .created_utc = core::utc_text(clock_.now_ns() + clock_.utc_minus_monotonic_ns())});
  return added ? list() : error_response(added.error());
}

dts::v1::Response KeyCommands::revoke(const dts::v1::RevokeKeyRequest& request) {
  if (keys_ == nullptr) return error_response(problem_);
  const auto revoked = keys_->revoke(request.name());
  return revoked ? list() : error_response(revoked.error());
}

}  // namespace dts::ipc
