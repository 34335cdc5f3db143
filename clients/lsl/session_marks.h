// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stop_token>
#include <string>

#include "core/log.h"
#include "core/result.h"
#include "core/token_bucket.h"
#include "dts/control_client.h"
#include "lsl/marker_inlets.h"

namespace dts::lsl {

/// Sets received markers in dtsd, each at its own time. What dtsd rejects is logged, without its text, which may be a name. Thread: one.
class SessionMarks {
 public:
  /// `rig`: gets the markers; empty: every rig.
  [[nodiscard]] static core::Result<SessionMarks> open(const std::string& control_endpoint, std::string rig, core::Log log);

  /// Waits for dtsd's answer, at most 3 s, or 0.1 s after a stop. Tries several times; dtsd executes one of the tries.
  void set(const ReceivedMarker& marker, const std::stop_token& stop);

 private:
  SessionMarks(client::ControlClient control, std::string rig, core::Log log)
      : control_(std::move(control)), rig_(std::move(rig)), log_(std::move(log)) {}

  client::ControlClient control_;
  std::string rig_;
  core::Log log_;
  core::TokenBucket reports_{1.0, 10.0};
};

}  // namespace dts::lsl
