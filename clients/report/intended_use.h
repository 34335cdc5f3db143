// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace dts::report {

/// What results are for and what they are not for, in short: stands wherever a result is. docs/device/intended-use.md says it in full.
/// `german` has the German; the dashboard has both in clients/web/src/strings, and its test compares all of them.
inline constexpr std::string_view kIntendedUse =
    "For research, teaching and supervised training. No diagnosis, no decision about treatment by these figures alone, no watch over a "
    "patient.";

}  // namespace dts::report
