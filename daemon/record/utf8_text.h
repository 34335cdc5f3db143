// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::record {

/// The text as XML 1.0 and JSON may hold it: bytes that are no UTF-8 and characters that XML forbids (control characters but tab and line
/// ends, U+FFFE, U+FFFF) become U+FFFD, one for one. Texts come from users and from files of other programs.
[[nodiscard]] std::string clean_text(std::string_view text);

}  // namespace dts::record
