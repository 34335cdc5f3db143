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

/// {"MVELO":{"value":8.19,"unit":"mm/s"}, ...}: measures that are defined, in their order. Values read back as the same double.
[[nodiscard]] JsonText to_json(const posturography::Measures& measures);
/// Measures that this program does not know, or knows by another unit, are left out. DataDamaged: no object of such objects.
[[nodiscard]] core::Result<posturography::Measures> measures_of_json(const std::string& text);

/// {"eyes":"open","feet":"two"}. Bytes that are not UTF-8 are replaced.
[[nodiscard]] JsonText to_json(const Labels& labels);
/// DataDamaged: no object of texts, or more than 32 of them.
[[nodiscard]] core::Result<Labels> labels_of_json(const std::string& text);

}  // namespace dts::record
