// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gmock/gmock.h>

#include <string>
#include <utility>
#include <vector>

#include "recordings_fixture.h"

namespace dts::session {

template <class Answer>
[[nodiscard]] std::string why_refused(const Answer& answer, core::ErrorCode code = core::ErrorCode::WrongState) {
  if (answer) return "";
  EXPECT_EQ(answer.error().code, code) << answer.error().what;
  return answer.error().what + "; " + answer.error().hint;
}

/// Standing, twice, with every phase: 0.5 s to settle, 11 s each, 1 s to rest.
[[nodiscard]] inline Protocol standing() {
  Protocol protocol{.name = "standing", .rig_kind = "floor", .definition = "name = standing"};
  protocol.trials =
      TrialPlan{.conditions = {{.name = "open", .labels = {{"eyes", "open"}}}, {.name = "closed", .labels = {{"eyes", "closed"}}}},
                .trials_per_block = 2,
                .settle_s = 0.5,
                .duration_s = 11.0,
                .rest_s = 1.0};
  return protocol;
}

class SupervisorTest : public RecordingsTest {
 protected:
  /// `s` seconds pass with scans, and the control thread looks every `tick_s`.
  void pass(double s, double tick_s = 0.05) {
    for (double passed = 0.0; passed < s - 1e-9; passed += tick_s) {
      feed(static_cast<std::size_t>(tick_s * 1500.0 + 0.5));
      supervisor_->tick();
    }
  }
  void silence(double s) {
    clock_.advance_s(s);
    supervisor_->tick();
  }
  RigState now() { return supervisor_->states().at(0); }
  void give(const HandFedDevice::Given& given) { device_->give(given); }
  std::vector<v1::Event> taken_events(v1::Event::BodyCase body) {
    std::vector<v1::Event> all;
    for (Notice& notice : supervisor_->take_notices()) {
      if (notice.event.body_case() == body) all.push_back(std::move(notice.event));
    }
    return all;
  }
  std::string log() { return std::exchange(said_, std::ostringstream()).str(); }
};

}  // namespace dts::session
