// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "core/log.h"
#include "core/result.h"

namespace dts::device {

/// Whether devices may start programs (`exec:`), and where the programs' error lines go. The configuration of the daemon decides:
/// `[devices] allow_exec`.
struct ProgramRights {
  bool are_allowed = false;
  core::Log log{};

  /// Fails with NotAllowed if `uri` must not start a program.
  [[nodiscard]] core::Status check(std::string_view uri) const;
};

}  // namespace dts::device
