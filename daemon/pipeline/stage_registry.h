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

/// A stage as the configuration names it.
struct StageConfig {
  std::string id;
  std::map<std::string, OptionValue, std::less<>> options;
};

struct StageEntry {
  const StageDescription& (*describe)();
  std::unique_ptr<Stage> (*create)(const StageOptions&, const StageContext&);
};

/// Every stage of this program. A new stage is one .h/.cpp pair and one line in stage_registry.cpp.
[[nodiscard]] std::span<const StageEntry> stage_registry();

/// All problems of `config` (unknown stage, unknown option, out of range), one sentence each, with a suggestion for
/// misspelt names; empty when it is fine.
[[nodiscard]] std::vector<std::string> check_stage(const StageConfig& config);

/// "window_filter window_scans=3 window_ms=0 shift_scans=1": the stage with all its options, given or by default, in the order of its
/// description. Two equal texts mean stages that compute the same: numbers are the shortest that read back as the same double. For a
/// config without problems; of an unknown stage only the id.
[[nodiscard]] std::string stage_text(const StageConfig& config);

/// Fails with InvalidArgument and the sentences of `check_stage`.
[[nodiscard]] core::Result<std::unique_ptr<Stage>> create_stage(const StageConfig& config, const StageContext& context);

}  // namespace dts::pipeline
