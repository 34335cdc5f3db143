// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "lab/sway/measured_trial.h"
#include "lab/sway/sway_arguments.h"

namespace dts::lab::sway {

inline constexpr std::size_t kMostFiles = 100'000;

/// A file to measure, and its facts from the command line.
struct SwayInput {
  std::string file;
  Labels labels{};
  std::string session{};  ///< From the labels session, subject and condition, for files without these facts.
  std::string subject{};
  std::string condition{};

  [[nodiscard]] bool is_recording() const { return file.ends_with(".xdf") || file.ends_with(".xdf.part"); }
};

/// Returns the files that the command line names. Searches folders recursively for *.csv, *.xdf, *.xdf.part, *.c3d, *.mot and *.sto, in
/// the order of names, without the table to be written. Fails with InvalidArgument if a file does not exist, a folder has no such file, a
/// label is invalid or has the name of a column or measure, or the number of values differs from the number of files. Fails with
/// LimitExceeded for more than `kMostFiles`.
[[nodiscard]] core::Result<std::vector<SwayInput>> sway_inputs(const SwayArguments& arguments);

}  // namespace dts::lab::sway
