// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::lab::simulate {

/// Returns the thesis's floor platform as a rig definition (see files::rig_definition), with the stages of the thesis. It is simulated if
/// no rig file is specified.
[[nodiscard]] std::string floor_definition(double rate_hz);

/// Returns a Kistler plate of the size 9281EA as a rig definition, whose centre of pressure is on top of something `top_mm` high.
[[nodiscard]] std::string force_plate_definition(double rate_hz, double top_mm);

/// Returns the chair of sim::chair_rig with the stages that find reaches. Classifying trunk movement needs a model, and therefore a rig
/// file.
[[nodiscard]] std::string chair_definition(double rate_hz);

}  // namespace dts::lab::simulate
