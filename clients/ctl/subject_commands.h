// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/console.h"
#include "ctl/arguments.h"
#include "dts/v1/sessions.pb.h"

namespace dts::ctl {

/// Commands about the visits of a subject. Each returns the exit status.
[[nodiscard]] int run_subject_trend(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_subject_plan(const Arguments& arguments, cli::Console& console);
[[nodiscard]] int run_subject_notes(const Arguments& arguments, cli::Console& console);

/// Prints the notes of a subject; nothing if there are none.
void print_notes(cli::Console& console, const v1::SubjectRecord& subject);
/// Prints the planned sessions of a subject; nothing if there are none.
void print_plan(cli::Console& console, const v1::SubjectRecord& subject);

}  // namespace dts::ctl
