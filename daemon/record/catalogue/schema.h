// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/result.h"
#include "record/catalogue/sqlite.h"

namespace dts::record {

/// "DTSc": marks a database as a catalogue (PRAGMA application_id), so that we never write to a database of another program.
inline constexpr std::int64_t kCatalogueMark = 0x44545363;

/// Returns the SQL of each step from one schema version to the next; the first creates version 1. Never change a released entry: add a new
/// entry at the end for each change of the schema.
[[nodiscard]] std::span<const char* const> catalogue_migrations() noexcept;

/// Applies the missing migrations. Each runs in its own transaction, which also sets the version (PRAGMA user_version). Fails with
/// WrongState for a database of another program and with Unsupported for a newer version, and changes neither of them. If a migration
/// fails, the database keeps the version that it had before that migration.
[[nodiscard]] core::Status migrate(const Database& database, std::span<const char* const> migrations);

}  // namespace dts::record
