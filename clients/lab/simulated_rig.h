// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dts::lab {

/// The thesis's floor platform as a rig definition (see files::rig_definition), with the stages of the thesis: what is simulated when no
/// rig file is given.
[[nodiscard]] std::string floor_definition(double rate_hz);

/// The chair of physics::chair_rig with the stages that find reaches; which trunk movement they were needs a model, and so a rig file.
[[nodiscard]] std::string chair_definition(double rate_hz);

}  // namespace dts::lab
