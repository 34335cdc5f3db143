// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "dts/v1/stream.pb.h"

namespace dts::ctl {

/// Returns "reach 3 final: P1 3.35  P2 2.87  P3 4.80 mm  [resumed]".
[[nodiscard]] std::string reach_text(const dts::v1::Reach& reach);
/// Returns "reach 3: moderate trunk movement, p 0.97, trunk 25.2 deg (18.1 .. 32.4)  [calibrated]".
[[nodiscard]] std::string movement_text(const dts::v1::TrunkMovement& movement);
/// Returns "result of trial 4 (150): moderate trunk movement ...; as expected for this target".
[[nodiscard]] std::string trial_result_text(const dts::v1::TrialResult& result);
/// Returns the value of a point in mm: "3.35"; "-" if it is not known.
[[nodiscard]] std::string point_text(bool is_known, const dts::v1::ReachPoint& point);
/// Returns the probabilities of the classes 1, 2 and 3: "0.00 0.03 0.97"; "-" without any.
[[nodiscard]] std::string probabilities_text(const dts::v1::TrunkMovement& movement);
/// Returns the trunk angle with its 90 % interval: "25.2 (18.1 .. 32.4)"; "-" if it is not known or the reach was rejected.
[[nodiscard]] std::string degrees_text(const dts::v1::TrunkMovement& movement);
/// Returns the word for a trunk class: "moderate".
[[nodiscard]] std::string class_word(int trunk_class);
/// Returns the word for the class of a reach, with its limits: a minor reach may be the arm alone; a rejected one has its reason: "rejected
/// (untared)".
[[nodiscard]] std::string class_words(const dts::v1::TrunkMovement& movement, std::uint32_t reach_flags);

}  // namespace dts::ctl
