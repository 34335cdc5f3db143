// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "fleet/hub/catalogue.h"
#include "fleet/hub/settings.h"

namespace dts::fleet::hub {

/// Fails with WrongState if two users have one key: the hub, a dashboard, a clinic that is not revoked. The message names all of them.
[[nodiscard]] core::Status check_keys(const std::string& hub_public_key, const std::vector<DashboardKey>& dashboards,
                                      const std::vector<Clinic>& clinics);

/// Returns the part of nats-server's configuration with its users: the hub, the dashboards, and the clinics that are not revoked, each with
/// what it may publish and receive. Has a key once, for the first of its users in this order: nats-server rejects a file with the same key
/// twice.
[[nodiscard]] std::string users_text(const std::string& hub_public_key, const std::vector<DashboardKey>& dashboards,
                                     const std::vector<Clinic>& clinics);

/// Writes the users file as a whole if it differs. Returns whether it was written.
[[nodiscard]] core::Result<bool> write_users(const Settings& settings, const std::string& hub_public_key,
                                             const std::vector<Clinic>& clinics);

/// Sends SIGHUP to the nats-server in `pid_file`, so that it reads its users again. Fails with NotFound if no nats-server has this number,
/// and with NotAllowed if the file cannot be read or the process not be signalled.
[[nodiscard]] core::Status reload_nats(const std::string& pid_file);

/// Returns the file that a clinic needs to connect: its name, the servers and the certificates of the authority. It holds no secret.
[[nodiscard]] std::string enrolment_text(const std::string& clinic, const std::vector<std::string>& servers, const std::string& ca_pem);

}  // namespace dts::fleet::hub
