// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/stat.h>

#include <string>

#include "dts/error.h"

namespace dts::gateway {

/// The text and attributes of an open users file.
struct UserText {
  std::string text{};
  struct stat facts {};
};
/// Fails with InvalidArgument if other users may read or change the file, or if it is too large for a users file.
[[nodiscard]] client::Result<UserText> read_user_text(int descriptor, const std::string& file);

}  // namespace dts::gateway
