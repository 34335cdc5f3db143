// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace dts::core {

/// Kind of an error. `dts.v1.ErrorCode` has the same values, and the exit status of dtsctl depends on them: never change a value.
enum class ErrorCode : std::uint8_t {
  Failed = 1,           ///< The operation failed for an external reason: I/O, memory, a peer.
  InvalidArgument = 2,  ///< A value or file of the user is wrong.
  Unreachable = 3,      ///< No answer at the endpoint.
  NotAllowed = 4,       ///< The caller's role or the operating system forbids it.
  NotFound = 5,         ///< No such rig, device, session or file.
  WrongState = 6,       ///< The operation is not possible in the current state.
  DataDamaged = 7,      ///< Stored or received data contradict themselves.
  Timeout = 8,          ///< The deadline passed.
  DeviceGone = 9,       ///< The device was unplugged or stopped answering.
  Unsupported = 10,     ///< This device, build or version does not support it.
  LimitExceeded = 11,   ///< A size, rate or count is above its documented limit.
  Internal = 12,        ///< A broken invariant: a bug in this program.
};

/// Returns one word per code, for logs and JSON: "wrong_state".
[[nodiscard]] std::string_view name(ErrorCode code) noexcept;

/// `what`: what failed, on which thing, and why. `hint`: what to do now; may be empty.
struct Error {
  ErrorCode code = ErrorCode::Failed;
  std::string what;
  std::string hint;

  friend bool operator==(const Error&, const Error&) = default;
};

/// Returns one line for a log: "what (hint)".
[[nodiscard]] std::string to_string(const Error& error);

template <class T>
using Result = tl::expected<T, Error>;
using Status = Result<void>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string what, std::string hint = {}) {
  return tl::make_unexpected(Error{code, std::move(what), std::move(hint)});
}

/// Returns the error of a failed system call: `what` plus the text of `system_errno`.
[[nodiscard]] tl::unexpected<Error> fail_errno(int system_errno, std::string what, std::string hint = {});

}  // namespace dts::core
