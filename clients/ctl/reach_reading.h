// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "dts/v1/stream.pb.h"

namespace dts::ctl {

/// "reach 3 final: P1 3.35  P2 2.87  P3 4.80 mm  [resumed]"
[[nodiscard]] std::string reach_text(const dts::v1::Reach& reach);
/// "reach 3: moderate trunk movement, p 0.97, trunk 25.2 deg (18.1 .. 32.4)  [calibrated]"
[[nodiscard]] std::string movement_text(const dts::v1::TrunkMovement& movement);
/// "result of trial 4 (150): moderate trunk movement ...; as the target takes"
[[nodiscard]] std::string trial_result_text(const dts::v1::TrialResult& result);
/// "moderate": what the numbers of the classes mean.
[[nodiscard]] std::string class_word(int trunk_class);
/// The same of a judgement: a minor reach may be the arm alone, and a rejected one says why: "rejected (untared)".
[[nodiscard]] std::string class_words(const dts::v1::TrunkMovement& movement, std::uint32_t reach_flags);

}  // namespace dts::ctl
