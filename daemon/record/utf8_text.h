// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dts::record {

/// Returns the text in a form that XML 1.0 and JSON allow. Replaces by U+FFFD each byte that is not UTF-8, and each character that XML
/// forbids (control characters except tab and line ends, U+FFFE, U+FFFF). Needed because users and files of other programs supply texts.
[[nodiscard]] std::string clean_text(std::string_view text);

}  // namespace dts::record
