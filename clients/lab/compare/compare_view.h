// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"
#include "lab/compare/compare.h"

namespace dts::lab::compare {

[[nodiscard]] cli::Json to_json(const Comparison& comparison);
void print(const Comparison& comparison, cli::Console& console);

/// Describes the alignment in one sentence, with its uncertainty.
[[nodiscard]] std::string alignment_text(const Comparison& comparison);
/// "2 pieces, offsets from 3.0936 to 3.2170 s"; for an alignment with pieces.
[[nodiscard]] std::string pieces_text(const Alignment& alignment);
/// Returns what the reader must know before using the values: lost pulses, stretches that nothing aligns, recordings that do not agree.
[[nodiscard]] std::vector<std::string> warnings_of(const Comparison& comparison);

}  // namespace dts::lab::compare
