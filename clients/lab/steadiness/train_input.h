// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "cli/console.h"
#include "core/result.h"
#include "lab/steadiness/discriminant_evaluation.h"
#include "lab/steadiness/discriminant_fit.h"
#include "lab/steadiness/steadiness_rows.h"

namespace dts::lab::steadiness {

/// What `steadiness train` was asked for.
struct TrainArguments {
  std::string table;  ///< Written by `dtslab sway --table`.
  std::string label;  ///< The column to predict from measures.
  std::string out;    ///< Empty: none is written.
  std::vector<std::string> measures;
  std::vector<std::string> where;    ///< "condition=ec_firm", "condition=ec_firm,eo_firm"
  std::vector<std::string> against;  ///< Columns of other facts; empty: those of `kUsualFacts` that the table has.
  std::string about;
  double noise_mm = 0.0;
  double noise_hz = 0.0;  ///< 0: the rate of the table.
  bool is_research = false;
  bool is_json = false;
};

/// The rows of the table, ready for the training.
struct TrainInput {
  std::vector<SteadinessRow> rows;
  Samples samples;
  std::vector<Rival> rivals;
  std::map<std::string, std::size_t> moved;  ///< By label: rows left out because the subject stepped off or moved the feet.
};

/// Reads the table and selects the rows. Warns about the rows that it leaves out. Fails with InvalidArgument, naming the table's line or
/// the option; adds errors in the table to `problems`.
[[nodiscard]] core::Result<TrainInput> read_train_input(const TrainArguments& arguments, cli::Console& console, files::Problems& problems);

}  // namespace dts::lab::steadiness
