// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "dts/v1/stream.pb.h"

namespace dts::ctl {

/// Returns the value of a measure by its symbol; nothing if it is absent.
[[nodiscard]] std::optional<double> measure_value(const dts::v1::Sway& sway, std::string_view symbol);
/// Returns the words of the flags: "short_for_quantiles moved".
[[nodiscard]] std::string sway_flag_words(const dts::v1::Sway& sway);
/// Returns "preliminary, trial 3, 12.5 s: velocity (MVELO) 8.1 mm/s  distance (RDIST) 5.2 mm  ellipse (PEA95_F) 223 mm2".
[[nodiscard]] std::string sway_text(const dts::v1::Sway& sway);

}  // namespace dts::ctl
