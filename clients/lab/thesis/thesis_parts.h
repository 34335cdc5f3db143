// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lab/thesis/thesis.h"

namespace dts::lab::thesis {

// One function per kind of table; `thesis_table` chooses.

/// Number of random draws of people for tables 5.2, 6.2 and 6.4.
inline constexpr std::size_t kReachDraws = 5;

/// Tables 3.2 (acrylic) and 3.3 (steel).
[[nodiscard]] core::Result<ThesisTable> thesis_deflections(bool is_steel);
/// Tables 3.4 (acrylic) and 3.5 (steel).
[[nodiscard]] core::Result<ThesisTable> thesis_proportions(bool is_steel);
/// Table 3.6.
[[nodiscard]] core::Result<ThesisTable> thesis_line_errors();
/// Table 4.1.
[[nodiscard]] core::Result<ThesisTable> thesis_loci();
/// Table 4.2, with figures 4.11 to 4.13.
[[nodiscard]] core::Result<ThesisTable> thesis_stack(const TableProgress& progress);
/// Table 5.2.
[[nodiscard]] core::Result<ThesisTable> thesis_teachers(const TableProgress& progress, std::size_t draws = kReachDraws);
/// Table 6.2.
[[nodiscard]] core::Result<ThesisTable> thesis_healthy(const TableProgress& progress, std::size_t draws = kReachDraws);
/// Table 6.3.
[[nodiscard]] core::Result<ThesisTable> thesis_trunk_angles();
/// Table 6.4.
[[nodiscard]] core::Result<ThesisTable> thesis_stroke(const TableProgress& progress, std::size_t draws = kReachDraws);

/// Returns (ours - printed) / printed, %; NaN if 0 is printed.
[[nodiscard]] double deviation_percent(double ours, double printed) noexcept;

}  // namespace dts::lab::thesis
