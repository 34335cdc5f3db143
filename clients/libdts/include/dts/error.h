// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace dts::client {

/// What went wrong, as a stable code: the numbers of `dts.v1.ErrorCode`.
enum class ErrorCode : std::uint8_t {
  Failed = 1,           ///< The operation failed for a reason of the world.
  InvalidArgument = 2,  ///< A value given by the caller is wrong.
  Unreachable = 3,      ///< Nobody answers at the endpoint.
  NotAllowed = 4,       ///< The caller's role or the operating system forbids it.
  NotFound = 5,         ///< No such rig, device or session.
  WrongState = 6,       ///< Legal, but not now.
  DataDamaged = 7,      ///< Received data contradict themselves.
  Timeout = 8,          ///< The deadline passed.
  DeviceGone = 9,       ///< The device was unplugged or stopped answering.
  Unsupported = 10,     ///< This daemon or version cannot do it.
  LimitExceeded = 11,   ///< A size, rate or count is above its limit.
  Internal = 12,        ///< A bug in the daemon or in this library.
};

/// One word per code, for JSON: "wrong_state".
[[nodiscard]] std::string_view name(ErrorCode code) noexcept;

/// What failed, on what and why (`what`), and what to try (`hint`, may be empty). Both are one line of UTF-8.
struct Error {
  ErrorCode code = ErrorCode::Failed;
  std::string what;
  std::string hint;

  friend bool operator==(const Error&, const Error&) = default;
};

template <class T>
using Result = tl::expected<T, Error>;

[[nodiscard]] inline tl::unexpected<Error> fail(ErrorCode code, std::string what, std::string hint = {}) {
  return tl::make_unexpected(Error{code, std::move(what), std::move(hint)});
}

/// Version of this library, "0.1.0"; equal to the daemon's when both come from one build.
[[nodiscard]] std::string_view version() noexcept;

}  // namespace dts::client
