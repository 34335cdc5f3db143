// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "core/result.h"
#include "dts/control_client.h"
#include "dts/error.h"

namespace dts::ctl {

/// What the daemon knows about the rig that is calibrated.
struct RigFacts {
  v1::RigInfo rig;
  std::string daq_model;
  std::string daq_serial;
  std::string session_id;  ///< Of the session under way; empty: none.

  /// Scans per second of a stream; fails with NotFound when the rig does not publish it, because nobody could measure it then.
  [[nodiscard]] client::Result<double> rate_hz(const std::string& stream) const;
  /// Fails with WrongState while a session is under way: weights and spacers have no place in somebody's recording.
  [[nodiscard]] client::Result<void> check_idle() const;
};

/// Asks the daemon. Fails with NotFound for an unknown rig and with DeviceGone for one whose device does not stream.
[[nodiscard]] client::Result<RigFacts> ask_rig_facts(client::ControlClient& dts, const std::string& rig);

/// Now, ISO 8601: "2026-01-31T12:00:00Z".
[[nodiscard]] std::string utc_now();

/// The same error for clients: codes of both have the same numbers.
[[nodiscard]] tl::unexpected<client::Error> as_client_error(const core::Error& error);

/// "name.toml" beside where the user is; fails with InvalidArgument when the file exists (a calibration is
/// never overwritten) or its folder cannot be written to: better before the measuring than after it.
[[nodiscard]] client::Result<std::string> free_file(const std::string& wanted);

}  // namespace dts::ctl
