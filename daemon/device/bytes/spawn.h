// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace dts::device::bytes {

/// The child's ends of its standard streams, and a pipe that closes when the program has started. All are above 2.
struct ChildEnds {
  int input = -1;
  int output = -1;
  int errors = -1;
  int failure = -1;  ///< Gets an errno, as an int, if the program could not be started.
};

/// Starts a program as a restricted child (README.md lists the restrictions) and returns its process number, or -1 with errno.
/// The caller's memory is shared, not copied, until the program has started: a copy would make every page of dtsd fault once, on the
/// threads of all rigs.
[[nodiscard]] pid_t spawn(const std::string& program, const std::vector<std::string>& argv, const std::vector<std::string>& environment,
                          const ChildEnds& ends);

}  // namespace dts::device::bytes
