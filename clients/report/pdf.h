// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "core/result.h"

namespace dts::report {

/// Turns SVG pages into one PDF document with text that can be searched and copied. Runs the program `rsvg-convert` (Debian package
/// librsvg2-bin) as a child with a fixed environment, at most 1 GiB of memory and 300 s of CPU time; nothing is fetched from a network and
/// nothing is written to a disk. `created_utc_s` is the date in the document: with the same programs and fonts, the same pages give the
/// same bytes in every time zone and language. Fails with Unsupported if the program is not installed, LimitExceeded for more than
/// `kMostPdfPages` pages, Failed if the program fails, takes longer than `longest` or `wants_more` returns false. Thread: any.
inline constexpr std::size_t kMostPdfPages = 400;
inline constexpr std::chrono::seconds kLongestPdf{300};
[[nodiscard]] core::Result<std::string> pdf_of(std::span<const std::string> svg_pages, std::int64_t created_utc_s,
                                               const std::function<bool()>& wants_more, std::chrono::seconds longest = kLongestPdf);

}  // namespace dts::report
