// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"
#include "fleet/worker/figures.h"

namespace dts::fleet::worker {

/// Returns the kinds of jobs: "sway", "reach", "replay".
[[nodiscard]] std::vector<std::string_view> kind_names();

/// Returns dtslab's words for an analysis of `file`, without the program; nothing for an unknown kind.
[[nodiscard]] std::optional<std::vector<std::string>> words_of(std::string_view kind, const std::string& file);

/// Returns the results in what dtslab printed for the recording of a part. The text comes from a program that has read a file of a clinic:
/// nothing in it is trusted. Fails with Unsupported for an unknown kind, and with DataDamaged if the text is no document of this kind.
[[nodiscard]] core::Result<Figures> figures_of(std::string_view kind, const std::string& output, std::uint32_t part);

}  // namespace dts::fleet::worker
