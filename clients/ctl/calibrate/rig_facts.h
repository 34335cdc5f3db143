// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "dts/control_client.h"
#include "dts/error.h"

namespace dts::ctl {

/// What the daemon reports about the rig to be calibrated.
struct RigFacts {
  v1::RigInfo rig;
  std::string daq_model;
  std::string daq_serial;
  std::string session_id;  ///< Of the running session; empty: none.

  /// Returns the scans per second of a stream. Fails with NotFound if the rig does not publish it, because it cannot be measured then.
  [[nodiscard]] client::Result<double> rate_hz(const std::string& stream) const;
  /// Fails with WrongState during a session: weights and spacers must not appear in a subject's recording.
  [[nodiscard]] client::Result<void> check_idle() const;
};

/// Requests the facts from the daemon. Fails with NotFound for an unknown rig, and with DeviceGone if its device does not stream.
[[nodiscard]] client::Result<RigFacts> ask_rig_facts(client::ControlClient& dts, const std::string& rig);

/// Returns the present time in ISO 8601: "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utc_now();

/// Converts an error of the core to one of the client: both have the same code numbers.
[[nodiscard]] tl::unexpected<client::Error> as_client_error(const core::Error& error);

/// Returns the name of a new file, such as "name.toml". Fails with InvalidArgument if the file exists (a calibration is never overwritten)
/// or if its folder is not writable. Call it before the measurement, so that no measurement is lost.
[[nodiscard]] client::Result<std::string> free_file(const std::string& wanted);

}  // namespace dts::ctl
