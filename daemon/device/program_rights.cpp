// SPDX-License-Identifier: Apache-2.0
#include "device/program_rights.h"

#include <string>

namespace dts::device {

core::Status ProgramRights::check(std::string_view uri) const {
  if (are_allowed) return {};
  return core::fail(core::ErrorCode::NotAllowed,
                    "device \"" + std::string(uri) + "\": this configuration does not allow devices that start a program",
                    "to allow them, write allow_exec = true under [devices] in dtsd.toml");
}

}  // namespace dts::device
