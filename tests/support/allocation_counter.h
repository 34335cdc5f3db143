// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dts::test {

/// Heap allocations and releases made so far by the calling thread. A program that links dts_test_allocations has its
/// operator new and delete replaced.
[[nodiscard]] std::uint64_t heap_calls_of_this_thread() noexcept;

/// The same for all threads whose name starts like that of a rig's thread ("acq-"), while counting is on.
void count_sample_threads(bool is_on) noexcept;
[[nodiscard]] std::uint64_t heap_calls_of_sample_threads() noexcept;

}  // namespace dts::test
