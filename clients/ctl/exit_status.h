// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

#include "dts/error.h"

namespace dts::ctl {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kInterrupted = 130;

/// The exit status that tells of an error. Several codes share "failed": scripts need not tell them apart.
[[nodiscard]] int exit_status(client::ErrorCode code) noexcept;

struct ExitMeaning {
  int status;
  std::string_view meaning;
};
/// What the manual page says.
inline constexpr std::array<ExitMeaning, 9> kExitMeanings{{{0, "success"},
                                                           {1, "failed, or time is up"},
                                                           {2, "wrong usage or bad input"},
                                                           {3, "the daemon is not reachable"},
                                                           {4, "not allowed"},
                                                           {5, "no such rig, device or session"},
                                                           {6, "not possible in the present state"},
                                                           {7, "damaged data"},
                                                           {130, "interrupted with Ctrl-C"}}};

}  // namespace dts::ctl
