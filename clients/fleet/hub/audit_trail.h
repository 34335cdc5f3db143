// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fleet/database/database.h"
#include "record/catalogue/audit_chain.h"

namespace dts::fleet::hub {

/// The audit trail of the centre: the table `audit`, chained like dtsd's. Every beat's answer carries the newest hash to a clinic: a trail
/// that was cut or computed again contradicts what the clinics hold.

/// Appends an entry. Call it within a transaction.
[[nodiscard]] core::Status append_audit(database::Database& database, std::int64_t utc_ns, const std::string& who, const std::string& what,
                                        const std::string& target);
/// Returns the newest entries, oldest first.
[[nodiscard]] core::Result<std::vector<record::AuditEntry>> newest_audit(database::Database& database, std::size_t count);
/// Returns the number of entries. Fails with DataDamaged, naming the entry, if the chain breaks.
[[nodiscard]] core::Result<std::uint64_t> verify_audit(database::Database& database);

}  // namespace dts::fleet::hub
