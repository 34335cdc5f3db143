// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "core/result.h"
#include "lab/steadiness/discriminant.h"
#include "lab/steadiness/discriminant_evaluation.h"

namespace dts::lab::steadiness {

/// A discriminant with the facts needed to use it.
struct SteadinessModel {
  std::string label;     ///< The column that it predicts.
  std::string profile;   ///< Of all training rows; empty: unknown or mixed.
  double rate_hz = 0.0;  ///< At which all training rows were analysed; 0: unknown or mixed.
  Discriminant discriminant;
  std::size_t rows = 0;
  std::size_t subjects = 0;
  double left_out_accuracy = 0.0;
  double left_out_balanced_accuracy = 0.0;
  bool is_better_than_chance = false;
};

[[nodiscard]] std::string model_text(const SteadinessModel& model);

/// Reads the text of `model_text`. Error messages use `name` for the file. Fails with InvalidArgument if the text is not such JSON, has
/// another format, has sizes that do not match, numbers out of range or unknown measures.
[[nodiscard]] core::Result<SteadinessModel> read_model_text(std::string_view text, const std::string& name);
/// Reads the same text from a file.
[[nodiscard]] core::Result<SteadinessModel> read_model(const std::string& file);

}  // namespace dts::lab::steadiness
