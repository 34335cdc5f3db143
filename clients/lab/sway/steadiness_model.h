// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "lab/sway/discriminant.h"
#include "lab/sway/discriminant_evaluation.h"

namespace dts::lab::steadiness {

/// A discriminant with what is to be known when it is used.
struct SteadinessModel {
  std::string label;    ///< The column that it tells.
  std::string profile;  ///< Of all rows of training; empty: not known, or different ones.
  Discriminant discriminant;
  std::size_t rows = 0;
  std::size_t subjects = 0;
  double left_out_accuracy = 0.0;
  double left_out_balanced_accuracy = 0.0;
  bool is_better_than_chance = false;
};

[[nodiscard]] std::string model_text(const SteadinessModel& model);

/// Reads what `model_text` wrote. `name` stands for the file in errors. InvalidArgument: no such JSON, another format, sizes that do not
/// fit together, numbers out of range, unknown measures.
[[nodiscard]] core::Result<SteadinessModel> read_model_text(std::string_view text, const std::string& name);
/// The same of a file.
[[nodiscard]] core::Result<SteadinessModel> read_model(const std::string& file);

}  // namespace dts::lab::steadiness
