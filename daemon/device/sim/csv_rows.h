// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.h"

namespace dts::device::sim {

/// What a file of numbers must look like.
struct CsvForm {
  std::string_view subject;  ///< In messages: "recording".
  std::string_view header;   ///< The first line; it decides how many columns there are.
  std::string_view hint;
  std::size_t max_rows = 0;
  std::size_t min_rows = 1;
};

/// The longest line that is read.
inline constexpr std::size_t kMaxCsvLineLength = 256;

/// Hands every row of a CSV file, finite numbers only, to `take` together with its place "file:line". Fails with NotFound, or with
/// InvalidArgument naming the place; what `take` refuses ends the reading.
[[nodiscard]] core::Status read_csv(const std::string& path, const CsvForm& form,
                                    const std::function<core::Status(std::span<const double> row, const std::string& place)>& take);

/// InvalidArgument: "place: why", with the form's hint.
[[nodiscard]] tl::unexpected<core::Error> refuse_row(const CsvForm& form, const std::string& place, const std::string& why);

}  // namespace dts::device::sim
