// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dts::test {

/// Whether the address or the thread sanitizer watches this program: tens of times slower, and what a process holds in memory says nothing.
#ifdef DTS_SANITIZED
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

}  // namespace dts::test
