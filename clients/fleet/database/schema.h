// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fleet/database/database.h"

namespace dts::fleet::database {

inline constexpr int kSchemaVersion = 4;

/// Creates the tables of an empty database, or changes those of an older version: each version in a transaction of its own. Several hubs
/// may start at once. Fails with Unsupported if a newer dts-hub has changed the tables, and with NotAllowed if the user of the database
/// may not create roles.
[[nodiscard]] core::Status migrate(Database& database);

}  // namespace dts::fleet::database
