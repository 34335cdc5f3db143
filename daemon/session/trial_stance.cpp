// SPDX-License-Identifier: Apache-2.0
#include "session/trial_stance.h"

#include <algorithm>

namespace dts::session {
namespace {

constexpr double kAnnouncedMs = 500.0;

}  // namespace

double stance_width_mm(const std::vector<std::pair<std::string, std::string>>& fields) {
  return field_number(fields, "stance_width_mm").value_or(0.0);
}

void announce_feet(pipeline::SubjectStances& stances, const TrialEvent& event, std::uint32_t segment, core::ScanIndex scan,
                   const core::Rate& raw_rate) {
  if (event.kind != TrialEventKind::Go) return;
  const bool is_on_one_foot = std::ranges::find(event.labels, std::pair<std::string, std::string>("feet", "one")) != event.labels.end();
  stances.change_feet(!is_on_one_foot, segment, scan + raw_rate.scans_in_ms(kAnnouncedMs));
}

}  // namespace dts::session
