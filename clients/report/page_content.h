// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "report/canvas.h"
#include "report/language.h"

namespace dts::report {

/// Content of a page, independent of the output format: texts are neither cleaned nor escaped.

struct Fact {
  std::string name;
  std::string value;
};

struct Column {
  std::string head;
  double share = 1.0;  ///< Fraction of the table's width.
  bool is_number = false;
};
struct Row {
  std::vector<std::string> cells;
  bool is_heading = false;  ///< One cell across all columns.
  std::string link{};       ///< Page to which the first cell links.
};
struct Table {
  std::string title;
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::vector<std::string> footnotes{};
};
struct Figure {
  std::string title;
  double width_mm = 0.0;
  double height_mm = 0.0;
  std::function<void(Canvas&)> draw;
};
struct Notes {
  std::string title;
  std::vector<std::string> items;
};
using Block = std::variant<Table, Figure, Notes>;

/// Blocks one below the other, in one or two columns side by side.
struct Section {
  std::vector<std::vector<Block>> columns;
};

struct PageContent {
  std::string title;
  std::string subtitle;
  std::vector<Fact> facts;
  std::vector<std::string> alerts;  ///< Warnings that the reader must not miss.
  std::vector<Section> sections;
  Language language = Language::English;
};

inline constexpr double kPageWidthMm = 210.0;  ///< A4
inline constexpr double kPageHeightMm = 297.0;
inline constexpr double kMarginMm = 10.0;
inline constexpr double kGutterMm = 5.0;
inline constexpr double kFullWidthMm = kPageWidthMm - 2.0 * kMarginMm;
inline constexpr double kHalfWidthMm = (kFullWidthMm - kGutterMm) / 2.0;

}  // namespace dts::report
