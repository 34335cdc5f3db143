// SPDX-License-Identifier: Apache-2.0
#include "gateway/access/identity.h"

#include <google/protobuf/descriptor.h>

namespace dts::gateway {

v1::Role role_needed(const v1::Request& request) {
  if (request.command_case() == v1::Request::COMMAND_NOT_SET) return v1::ROLE_UNSPECIFIED;
  const auto* field = v1::Request::descriptor()->FindFieldByNumber(request.command_case());
  return field == nullptr ? v1::ROLE_UNSPECIFIED : field->options().GetExtension(v1::role_needed);
}

}  // namespace dts::gateway
