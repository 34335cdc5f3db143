// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/result.h"
#include "lab/compare/alignment.h"
#include "lab/compare/recording.h"

namespace dts::lab::compare {

/// Returns whether both recordings have at least ten rising edges that are about one common period apart.
[[nodiscard]] bool have_pulse_trains(const Recording& a, const Recording& b);

/// Aligns by a pulse train that both recordings have. Pulses look alike, so the train alone leaves an offset of whole periods open: the
/// clock of one computer decides if both recordings have its times, else the signals. Reports each pulse that only one recording has. Fails
/// with Failed if neither decides, and with LimitExceeded for more than 200,000 pulses.
[[nodiscard]] core::Result<Alignment> align_by_pulse_train(const Recording& a, const Recording& b);

}  // namespace dts::lab::compare
