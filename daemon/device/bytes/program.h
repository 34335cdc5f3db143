// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/clock.h"
#include "core/log.h"
#include "device/bytes/byte_link.h"

namespace dts::device::bytes {

/// Creates a closed link to a program: `open` starts it as a restricted child, its stdin and stdout are the link. Lines of its stderr go to
/// `log`, at most 5 per second, on a thread of the link's own; the newest ones are in `why_lost`. README.md states what the child may do.
/// `argv`: see `split_command`. `clock` must outlive the link.
[[nodiscard]] std::unique_ptr<ByteLink> run_program(std::vector<std::string> argv, core::Clock& clock, core::Log log);

}  // namespace dts::device::bytes
