// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace dts::gateway {

/// The parts of a request target in origin form: "/a%20b?x=1" is path "/a b", query {x: 1}.
struct RequestTarget {
  std::string path;
  std::map<std::string, std::string> query;
};

/// Returns nothing for a target that no browser sends to us: another form than "/path?query", a "." or ".." segment (also an encoded one),
/// a backslash, a control character, an invalid escape, text that is not UTF-8, a key that occurs twice in the query. Decodes once: "%252e"
/// is "%2e".
[[nodiscard]] std::optional<RequestTarget> parse_target(std::string_view target);

/// Returns nothing for an invalid escape.
[[nodiscard]] std::optional<std::string> percent_decoded(std::string_view text, bool plus_is_space = false);

}  // namespace dts::gateway
