// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <string_view>

#include "core/cell_text.h"
#include "core/join.h"
#include "core/utf8.h"

namespace dts::cli {

/// Why a command failed.
struct Failure {
  std::string what;
  std::string hint;
  int code = 0;  ///< Number of the code in `dts.v1.ErrorCode`; 0: the exit status is the code.
};

/// The output streams, and what the terminal or reader behind them supports.
struct Console {
  std::ostream& out;      ///< Results.
  std::ostream& talk;     ///< Everything else: errors, hints, progress.
  std::string program{};  ///< The program's name, for errors; set by `run`.
  bool is_out_terminal = false;
  bool is_talk_terminal = false;
  bool has_colours = false;   ///< On `out`: a terminal, and NO_COLOR is not set.
  bool can_redraw = false;    ///< On `out`: a terminal that can move its cursor.
  std::size_t columns = 100;  ///< Width of `out`.
  std::size_t lines = 24;     ///< Its height.
  /// Returns true if the reader of `out` has closed it, without writing to it.
  std::function<bool()> is_out_closed = [] { return false; };
  /// Returns true if the user pressed q since the last call. For views that are drawn until the user ends them; the first call lets the
  /// terminal deliver single keys.
  std::function<bool()> is_quit_asked = [] { return false; };
  /// Reads the terminal's size again into `columns` and `lines`: the user may have resized it.
  std::function<void(Console&)> measure = [](Console& /*console*/) {};
  std::optional<Failure> failure{};  ///< The last error that was printed.
};

enum class Style { Plain, Bold, Good, Warning, Bad, Faint };

/// Returns `text` in a style, or unchanged if the console has no colours.
[[nodiscard]] std::string styled(const Console& console, Style style, std::string_view text);
/// Makes text from outside safe for the terminal: removes control characters.
using core::join;
using core::printable;
/// Makes text from outside safe for a CSV file: no spreadsheet evaluates it as a formula.
using core::csv_cell;

/// Prints "dtsctl: what" and, if there is a hint, "  try: hint" to `talk`, and stores both in `failure`.
void print_error(Console& console, std::string_view what, std::string_view hint = {});
/// Prints what to do next; only for people, that is, if `talk` is a terminal.
void print_hint(Console& console, std::string_view text);

}  // namespace dts::cli
