// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <string>

#include "dts/error.h"

namespace dts::gateway {

/// An open users file as it stands there.
struct UserText {
  std::string text{};
  struct stat facts {};
};
/// InvalidArgument when others may read or change it, or it is too large to be one.
[[nodiscard]] client::Result<UserText> read_user_text(int descriptor, const std::string& file);

}  // namespace dts::gateway
