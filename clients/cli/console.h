// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "core/cell_text.h"
#include "core/utf8.h"

namespace dts::cli {

/// Why a command failed.
struct Failure {
  std::string what;
  std::string hint;
  int code = 0;  ///< By its number in `dts.v1.ErrorCode`; 0: the exit status says it.
};

/// Where output goes and what the reader at the other end can take.
struct Console {
  std::ostream& out;      ///< Results.
  std::ostream& talk;     ///< Everything else: errors, hints, progress.
  std::string program{};  ///< Its name, for errors; `run` sets it.
  bool is_out_terminal = false;
  bool is_talk_terminal = false;
  bool has_colours = false;   ///< On `out`: a terminal, and NO_COLOR is not set.
  bool can_redraw = false;    ///< On `out`: a terminal that moves its cursor.
  std::size_t columns = 100;  ///< Width of `out`.
  std::size_t lines = 24;     ///< Its height.
  /// Tells that whoever read `out` has left, without writing to it.
  std::function<bool()> is_out_closed = [] { return false; };
  /// Reads the terminal's size again into `columns` and `lines`: a person may have resized it.
  std::function<void(Console&)> measure = [](Console& /*console*/) {};
  std::optional<Failure> failure{};  ///< The last error that was printed.
};

enum class Style { Plain, Bold, Good, Warning, Bad, Faint };

/// `text` in a style, or as it is without colours.
[[nodiscard]] std::string styled(const Console& console, Style style, std::string_view text);
/// For text from outside: it cannot drive the terminal.
using core::printable;
/// For text from outside: no spreadsheet computes it.
using core::csv_cell;

/// Prints "dtsctl: what" and, if there is a hint, "  try: hint" to `talk`, and remembers it as the failure.
void print_error(Console& console, std::string_view what, std::string_view hint = {});
/// A word on what to do next; only for people, that is, when `talk` is a terminal.
void print_hint(Console& console, std::string_view text);

}  // namespace dts::cli
