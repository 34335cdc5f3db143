// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/audit_chain.h"
#include "record/catalogue/sqlite.h"

namespace dts::record {

/// The table `audit`, and a second trail in the file NAME.audit beside the catalogue. Each entry appends its line "number hash" to the
/// file. The file is not synchronised and may lack lines (after a crash, a full disk), but every whole line must match the table.
///
/// | somebody                                                     | is detected                                            |
/// |--------------------------------------------------------------|--------------------------------------------------------|
/// | changes, removes or inserts an entry                         | by the chain of hashes                                 |
/// | removes the newest entries, or restores an older catalogue   | by the second trail: it has lines without entries      |
/// | does the same and also rewrites the second trail or computes | only if the second trail cannot be rewritten:          |
/// | a new chain                                                  | `chattr +a` by root, or a copy kept elsewhere          |
/// | removes the second trail                                     | only until the next entry creates a new one            |
/// | does something that writes no entry                          | never                                                  |
///
/// Thread: one at a time.
class AuditTrail {
 public:
  explicit AuditTrail(const Database& database) : database_(&database), second_file_(database.file() + ".audit") {}

  /// Appends an entry. Cuts texts longer than 1 KiB.
  [[nodiscard]] core::Status append(AuditEntry entry) const;
  [[nodiscard]] core::Result<std::vector<AuditEntry>> newest(std::size_t count) const;
  [[nodiscard]] core::Result<std::uint64_t> verify() const;

 private:
  [[nodiscard]] AuditEntry last() const;
  [[nodiscard]] core::Status append_second(const AuditEntry& entry) const;
  [[nodiscard]] core::Status verify_second(std::uint64_t entries) const;
  [[nodiscard]] core::Status verify_line(Statement& find, const std::string& line) const;

  const Database* database_;
  std::string second_file_;
};

}  // namespace dts::record
