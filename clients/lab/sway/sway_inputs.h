// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "lab/sway/measured_trial.h"
#include "lab/sway/sway_arguments.h"

namespace dts::lab::steadiness {

inline constexpr std::size_t kMostFiles = 100'000;

/// A file to measure, and what the command line says of it.
struct SwayInput {
  std::string file;
  Labels labels{};
  std::string session{};  ///< Given as labels session, subject, condition: for files that do not say.
  std::string subject{};
  std::string condition{};

  [[nodiscard]] bool is_recording() const { return file.ends_with(".xdf") || file.ends_with(".xdf.part"); }
};

/// The files that the command line names; folders are walked through for *.csv, *.xdf and *.xdf.part, in the order of names, without the
/// table that is to be written. InvalidArgument: no such file, a folder without any, a label that is none or whose name is that of a
/// column or measure, values that are not as many as the files. LimitExceeded: more than `kMostFiles`.
[[nodiscard]] core::Result<std::vector<SwayInput>> sway_inputs(const SwayArguments& arguments);

}  // namespace dts::lab::steadiness
