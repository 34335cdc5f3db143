// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ctl/calibrate/measure.h"
#include "ctl/calibrate/prompt.h"

namespace dts::ctl {

/// Guides a person with spacers from gap to gap. All parts must outlive the guide.
struct GapGuideParts {
  const std::vector<double>& gaps_mm;
  Measurer& measurer;
  const Prompt* prompt = nullptr;  ///< nullptr: a new steady voltage is the next gap, see `measure_gaps`.
  std::function<void(const std::string&)> say;
  std::vector<std::string> labels{};  ///< Of the sensors, for messages.
};

/// Returns the voltages of all sensors at each gap, in the order of the gaps; fewer if the person quit.
///
/// Without a prompt, the first steady voltage belongs to the sensors without a spacer; it is never recorded. After that, a steady voltage
/// is the next gap if it differs at all sensors by more than 20 mV from the one before, and from the voltage without a spacer.
[[nodiscard]] client::Result<std::vector<SteadyReading>> measure_gaps(const GapGuideParts& parts);

}  // namespace dts::ctl
