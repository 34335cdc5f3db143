// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/result.h"
#include "record/catalogue/sqlite.h"

namespace dts::record {

/// "DTSc": marks a database as a catalogue (PRAGMA application_id), so that no other program's file is written to.
inline constexpr std::int64_t kCatalogueMark = 0x44545363;

/// SQL that leads from one version of the schema to the next; the first makes version 1. What has been released never changes: a change of
/// the schema is another entry at the end.
[[nodiscard]] std::span<const char* const> catalogue_migrations() noexcept;

/// Applies the migrations that the file lacks, each in a transaction of its own with its version (PRAGMA user_version). A file of another
/// program: WrongState; of a newer version: Unsupported. Neither is touched. After a failure the file is at the last version that was
/// reached.
[[nodiscard]] core::Status migrate(const Database& database, std::span<const char* const> migrations);

}  // namespace dts::record
