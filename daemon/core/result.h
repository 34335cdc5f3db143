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

/// Evaluates the expression once. If it is an error, returns that error from the function; otherwise continues. A value is dropped.
///
///     DTS_TRY(check(request));
///
/// The function may return any Result, a Status or a tl::expected with the same kind of error. A lambda needs its return type written out.
/// It is not for functions that add a place to the message, such as the name of a file: write `if (!x) return fail(...)` there.
#define DTS_TRY(...) DTS_TRY_NAMED(DTS_TRY_JOIN(dts_tried_, __LINE__), __VA_ARGS__)

/// The same for an expression whose value is needed: moves the value into the declaration, or into a variable that exists.
///
///     DTS_TRY_ASSIGN(const auto protocol, find_protocol(name));   // protocol is the value, not the Result
///     DTS_TRY_ASSIGN(options.rate_hz, reader.number("rate_hz"));
///
/// It is several statements: it needs the braces of a block around it. The declaration cannot contain a comma, so no `auto [a, b]`.
#define DTS_TRY_ASSIGN(declaration, ...) DTS_TRY_ASSIGN_NAMED(DTS_TRY_JOIN(dts_tried_, __LINE__), declaration, __VA_ARGS__)

// What the two consist of. The line number makes the name of the hidden variable unique, so that nested blocks do not shadow it.
#define DTS_TRY_NAMED(tried, ...)                                                                   \
  do {                                                                                              \
    if (auto tried = (__VA_ARGS__); !tried) return ::tl::make_unexpected(std::move(tried).error()); \
  } while (false)
#define DTS_TRY_ASSIGN_NAMED(tried, declaration, ...)                 \
  auto tried = (__VA_ARGS__);                                         \
  if (!tried) return ::tl::make_unexpected(std::move(tried).error()); \
  declaration = *std::move(tried)
#define DTS_TRY_JOIN(word, line) DTS_TRY_JOIN_EXPANDED(word, line)
#define DTS_TRY_JOIN_EXPANDED(word, line) word##line
