// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"

namespace dts::ctl {

/// Writes the recordings of all parts of a session as CSV, as a BIDS dataset, as C3D or as a FHIR Bundle. Overwrites nothing; an
/// interrupted export leaves no files.
[[nodiscard]] int run_session_export(const Arguments& arguments, cli::Console& console);

}  // namespace dts::ctl
