// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "cli/console.h"
#include "dts/v1/control.pb.h"

namespace dts::ctl {

/// Print tables from the catalogue and the protocols.
void print_sessions(cli::Console& console, const v1::ListSessionsResponse& sessions);
/// `elapsed_s`: how long a session that is under way runs; nothing for any other session.
void print_session(cli::Console& console, const v1::SessionRecord& session, std::optional<double> elapsed_s);
void print_protocols(cli::Console& console, const v1::ListProtocolsResponse& protocols);
void print_protocol(cli::Console& console, const v1::ProtocolInfo& protocol);
void print_audit(cli::Console& console, const v1::GetAuditResponse& audit);

/// Returns one line, such as "subject ID: P071 -> P017, 2026-11-21 14:45:25 UTC, local: typing error".
[[nodiscard]] std::string correction_text(const v1::Correction& correction);

}  // namespace dts::ctl
