// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tl/expected.hpp>
#include <utility>

// The macros of the daemon's core/result.h, which a client must not include. Keep them equal.

/// Evaluates the expression once. If it is an error, returns that error from the function; otherwise continues. A value is dropped.
///
///     DTS_TRY(check(request));
///
/// The function may return any Result or tl::expected with the same kind of error. A lambda needs its return type written out.
/// It is not for functions that add a place to the message, such as the name of a file: write `if (!x) return fail(...)` there.
#define DTS_TRY(...) DTS_TRY_NAMED(DTS_TRY_JOIN(dts_tried_, __LINE__), __VA_ARGS__)

/// The same for an expression whose value is needed: moves the value into the declaration.
///
///     DTS_TRY_ASSIGN(const auto keys, read_keys(file));   // keys is the value, not the Result
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
