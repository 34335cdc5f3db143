// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "report/canvas.h"

namespace dts::report {

/// What a page says, whatever it is written in: texts are as they came, neither cleaned nor escaped.

struct Fact {
  std::string name;
  std::string value;
};

struct Column {
  std::string head;
  double share = 1.0;  ///< Of the table's width.
  bool is_number = false;
};
struct Row {
  std::vector<std::string> cells;
  bool is_heading = false;  ///< One cell, across.
  std::string link{};       ///< Page that the first cell leads to.
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

/// Blocks one below the other; one or two of them side by side.
struct Section {
  std::vector<std::vector<Block>> columns;
};

struct PageContent {
  std::string title;
  std::string subtitle;
  std::vector<Fact> facts;
  std::vector<std::string> alerts;  ///< What nobody may overlook.
  std::vector<Section> sections;
};

inline constexpr double kPageWidthMm = 210.0;  ///< A4
inline constexpr double kPageHeightMm = 297.0;
inline constexpr double kMarginMm = 10.0;
inline constexpr double kGutterMm = 5.0;
inline constexpr double kFullWidthMm = kPageWidthMm - 2.0 * kMarginMm;
inline constexpr double kHalfWidthMm = (kFullWidthMm - kGutterMm) / 2.0;

}  // namespace dts::report
