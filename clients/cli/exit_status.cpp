// SPDX-License-Identifier: Apache-2.0
#include "cli/exit_status.h"

namespace dts::cli {

int exit_status(int code) noexcept {
  constexpr int kInvalidArgument = 2;
  constexpr int kDataDamaged = 7;
  return code >= kInvalidArgument && code <= kDataDamaged ? code : kFailed;
}

}  // namespace dts::cli
