// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cerrno>
#include <cstdint>
#include <string>
#include <vector>

#include "fault/faulty_disk.h"
#include "fault/reference.h"

namespace dts::fault {

inline constexpr std::array kErrors{ENOSPC, EIO, EDQUOT, EROFS};

/// How many calls of each operation a little session makes on a sound disk: its opening, two seconds of recording, its end.
struct CallCounts {
  std::array<std::uint64_t, kOperations.size()> calls{};
  std::string problem;
};
[[nodiscard]] CallCounts count_calls(const Reference& reference);

/// The same session with one fault, then a look at what is left. In a process of its own. Empty: every promise was kept.
struct Injected {
  std::string problem;
  bool has_struck = false;
  std::string outcome;  ///< "refused", "complete", "incomplete", "recovered"
};
[[nodiscard]] Injected inject(const Fault& fault, const Reference& reference);

/// Every n of every operation, each with one error in turn, once and lasting.
[[nodiscard]] std::vector<Fault> all_faults(const CallCounts& counts);

/// The little session alone, on whatever disk `folder` is on. What went wrong, or nothing.
[[nodiscard]] std::string record_little_session(const std::string& folder);

/// What the little session's device gives.
[[nodiscard]] Reference little_reference();

}  // namespace dts::fault
