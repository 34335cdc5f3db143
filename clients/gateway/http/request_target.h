// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace dts::gateway {

/// A request target in origin form, taken apart: "/a%20b?x=1" is path "/a b", query {x: 1}.
struct RequestTarget {
  std::string path;
  std::map<std::string, std::string> query;
};

/// Nothing for what no browser sends to us: another form than "/path?query", a "." or ".." segment (also an encoded one), a backslash, a
/// control character, an escape that is none, text that is not UTF-8, a query that says a thing twice. Decodes once: "%252e" is "%2e".
[[nodiscard]] std::optional<RequestTarget> parse_target(std::string_view target);

/// Nothing for an escape that is none.
[[nodiscard]] std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_space = false);

/// Whole, shortest-form UTF-8 without surrogates (RFC 3629): an overlong "/" is not a "/".
[[nodiscard]] bool is_utf8(std::string_view text) noexcept;

}  // namespace dts::gateway
