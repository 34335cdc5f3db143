// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::device::sim {

/// The required form of a file of numbers.
struct CsvForm {
  std::string_view subject;  ///< Kind of file in messages: "recording".
  std::string_view header;   ///< The first line; it determines the number of columns.
  std::string_view hint;
  std::size_t max_rows = 0;
  std::size_t min_rows = 1;
};

/// Longest allowed line, characters.
inline constexpr std::size_t kMaxCsvLineLength = 256;

/// Calls `add_row` with every row of a CSV file (finite numbers only) and its place "file:line". Fails with NotFound, with InvalidArgument,
/// naming the place, or with the first error of `add_row`.
[[nodiscard]] core::Status read_csv(const std::string& path, const CsvForm& form,
                                    const std::function<core::Status(std::span<const double> row, const std::string& place)>& add_row);

/// Returns InvalidArgument with the text "place: why" and the hint of `form`.
[[nodiscard]] tl::unexpected<core::Error> refuse_row(const CsvForm& form, const std::string& place, const std::string& why);

}  // namespace dts::device::sim
