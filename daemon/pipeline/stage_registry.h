// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "pipeline/stage.h"

namespace dts::pipeline {

/// A stage and its options in the configuration.
struct StageConfig {
  std::string id;
  std::map<std::string, OptionValue, std::less<>> options;
};

struct StageEntry {
  const StageDescription& (*describe)();
  std::unique_ptr<Stage> (*create)(const StageOptions&, const StageContext&);
};

/// Returns every stage of this program. A new stage needs one .h/.cpp pair and one line in stage_registry.cpp.
[[nodiscard]] std::span<const StageEntry> stage_registry();

/// Returns all problems of `config` (unknown stage, unknown option, value out of range), one sentence each, with a suggestion for misspelt
/// names; empty if there is none.
[[nodiscard]] std::vector<std::string> check_stage(const StageConfig& config);

/// Returns "window_filter window_scans=3 window_ms=0 shift_scans=1": the stage with all its options, defaults included, in the order of its
/// description. Stages with equal texts compute the same: numbers are written in the shortest form that reads back as the same double.
/// `config` must have no problems; for an unknown stage, returns only the ID.
[[nodiscard]] std::string stage_text(const StageConfig& config);

/// Creates a stage. Fails with InvalidArgument and the sentences of `check_stage`.
[[nodiscard]] core::Result<std::unique_ptr<Stage>> create_stage(const StageConfig& config, const StageContext& context);

}  // namespace dts::pipeline
