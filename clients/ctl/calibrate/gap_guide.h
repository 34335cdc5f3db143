// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ctl/calibrate/measure.h"
#include "ctl/calibrate/prompt.h"

namespace dts::ctl {

/// Leads a person with spacers from gap to gap. All parts outlive the guide.
struct GapGuideParts {
  const std::vector<double>& gaps_mm;
  Measurer& measurer;
  const Prompt* prompt = nullptr;  ///< nullptr: a new steady voltage is the next gap, see `measure_gaps`.
  std::function<void(const std::string&)> say;
  std::vector<std::string> labels{};  ///< Of the sensors, for messages.
};

/// The voltages of all sensors at each gap, in the order of the gaps; fewer when the person quit.
///
/// Without a person the first steady voltage is that of the sensors with nothing before them; it is never recorded. Every other steady
/// voltage that differs from the one before by more than 20 mV at all sensors is the next gap.
[[nodiscard]] client::Result<std::vector<SteadyReading>> measure_gaps(const GapGuideParts& parts);

}  // namespace dts::ctl
