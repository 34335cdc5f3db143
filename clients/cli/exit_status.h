// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>
#include <type_traits>

#include "cli/console.h"

namespace dts::cli {

inline constexpr int kOk = 0;
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;
inline constexpr int kInterrupted = 130;

/// Returns the exit status for an error code, a number of `dts.v1.ErrorCode`. Several codes share the status "failed": scripts need not
/// distinguish them.
[[nodiscard]] int exit_status(int code) noexcept;
template <class Code>
requires std::is_enum_v<Code>
[[nodiscard]] int exit_status(Code code) noexcept { return exit_status(static_cast<int>(code)); }

/// Prints an error and returns its exit status. Error is dts::client::Error or dts::core::Error: both have `code`, `what` and `hint`, and
/// the same numbers for codes.
template <class Error>
[[nodiscard]] int fail_with(Console& console, const Error& error) {
  print_error(console, error.what, error.hint);
  console.failure->code = static_cast<int>(error.code);
  return exit_status(error.code);
}

struct ExitMeaning {
  int status;
  std::string_view meaning;
};
/// Exit statuses for the manual page.
inline constexpr std::array<ExitMeaning, 9> kExitMeanings{{{0, "success"},
                                                           {1, "failed, or no result within the time limit"},
                                                           {2, "wrong usage or invalid input"},
                                                           {3, "the daemon is not reachable"},
                                                           {4, "not allowed"},
                                                           {5, "no such rig, topic, device or session"},
                                                           {6, "not possible in the present state"},
                                                           {7, "damaged data"},
                                                           {130, "interrupted with Ctrl-C"}}};

}  // namespace dts::cli
