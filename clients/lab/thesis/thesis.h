// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace dts::lab::thesis {

/// A value that is not finite is undefined.
struct Figure {
  std::string name;  ///< With unit: "fem_mm".
  double value;
  bool is_in_table = true;  ///< false: only in the JSON document, to keep the table narrow.
};
using Figures = std::vector<Figure>;

/// A row of a thesis table: the printed values, our values, and the deviations.
struct ThesisRow {
  std::string label;
  Figures printed;
  Figures ours;
  Figures deviation;
};

struct ThesisTable {
  std::string name;   ///< "3.2"
  std::string title;  ///< As in the thesis.
  int decimals = 3;   ///< Of printed and computed values.
  std::vector<ThesisRow> rows;
  Figures summary;
  std::string figures;             ///< Script for gnuplot that draws the figures that belong to the table; empty: none.
  std::vector<std::string> notes;  ///< Assumptions, and printed figures that do not follow from the stated theory.
};

/// Names of the tables that `thesis_table` can compute.
[[nodiscard]] const std::vector<std::string_view>& thesis_table_names();

/// Receives the computed fraction of a table, 0..1.
using TableProgress = std::function<void(double)>;

/// Computes a table. Fails with InvalidArgument for an unknown table.
[[nodiscard]] core::Result<ThesisTable> thesis_table(
    std::string_view name, const TableProgress& progress = [](double) {});

}  // namespace dts::lab::thesis
