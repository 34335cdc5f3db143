// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "posturography/measure.h"
#include "record/event.h"

namespace dts::record {

using Labels = std::vector<std::pair<std::string, std::string>>;

/// Returns {"MVELO":{"value":8.19,"unit":"mm/s"}, ...} with the defined measures, in their order. Values read back as the same double.
[[nodiscard]] JsonText to_json(const posturography::Measures& measures);
/// Reads the text of `to_json`. Skips measures that this program does not know or has in another unit. Fails with DataDamaged if the text
/// has another form.
[[nodiscard]] core::Result<posturography::Measures> measures_of_json(const std::string& text);

/// Returns {"eyes":"open","feet":"two"}. Replaces bytes that are not UTF-8.
[[nodiscard]] JsonText to_json(const Labels& labels);
/// Fails with DataDamaged if the text is no JSON object of texts, or has more than 32 labels.
[[nodiscard]] core::Result<Labels> labels_of_json(const std::string& text);

}  // namespace dts::record
