// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

#include "dts/export.h"

/// The C++ client of dtsd.
namespace dts::client {

/// What failed, as a stable code: the numbers of `dts.v1.ErrorCode`.
enum class ErrorCode : std::uint8_t {
  Failed = 1,           ///< The operation failed for a reason outside the program.
  InvalidArgument = 2,  ///< A value given by the caller is wrong.
  Unreachable = 3,      ///< No daemon answers at the endpoint.
  NotAllowed = 4,       ///< The caller's role or the operating system forbids it.
  NotFound = 5,         ///< No such rig, device or session.
  WrongState = 6,       ///< The operation is valid, but not in the present state.
  DataDamaged = 7,      ///< Received data contradict themselves.
  Timeout = 8,          ///< The deadline passed.
  DeviceGone = 9,       ///< The device was unplugged or stopped answering.
  Unsupported = 10,     ///< This daemon or version cannot do it.
  LimitExceeded = 11,   ///< A size, rate or count is above its limit.
  Internal = 12,        ///< A bug in the daemon or in this library.
};

/// Returns one word per code, for JSON: "wrong_state". Thread: any.
[[nodiscard]] DTS_API std::string_view name(ErrorCode code) noexcept;

/// Why an operation failed. Both texts are one line of UTF-8.
struct Error {
  ErrorCode code = ErrorCode::Failed;  ///< For programs: decides what to do.
  std::string what;                    ///< What failed, on which thing, and why.
  std::string hint;                    ///< What to try; may be empty.

  /// Compares code and both texts.
  friend bool operator==(const Error&, const Error&) = default;
};

/// A value, or the reason why there is none.
template <class T>
using Result = tl::expected<T, Error>;

/// Returns an error that converts to every Result. Thread: any.
[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string what, std::string hint = {}) {
  return tl::make_unexpected(Error{code, std::move(what), std::move(hint)});
}

/// Returns the version of this library, "0.2.0"; equal to the daemon's version if both are from the same build. Thread: any.
[[nodiscard]] DTS_API std::string_view version() noexcept;

}  // namespace dts::client
