// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.h"
#include "record/catalogue/catalogue.h"
#include "record/catalogue/sqlite.h"

namespace dts::record {

/// SHA-256 in lower-case hexadecimal over
///
///     hash of the entry before    64 bytes, as text; of the first entry: 64 times '0'
///     number, utc_ns, who, what, target, result, each as
///         length                  8 bytes, little-endian
///         text                    numbers in decimal
///
/// The lengths keep "a" + "bc" and "ab" + "c" apart.
[[nodiscard]] std::string audit_hash(const std::string& before, const AuditEntry& entry);

/// The table `audit`, and a second trail beside the catalogue: NAME.audit, to which every entry adds its line "number hash". It is not
/// synchronised and may lack lines (a crash, a full disk), but what it has must agree with the table.
///
/// | somebody                                                         | shows                                              |
/// |------------------------------------------------------------------|----------------------------------------------------|
/// | changes, removes or puts in an entry                             | by the chain                                       |
/// | cuts off the newest entries, or puts back an older catalogue     | by the second trail: it has lines without entries  |
/// | the same, and cuts the second trail too, or computes a new chain | only where the second trail cannot be rewritten:   |
/// |                                                                  | `chattr +a` by root, or a copy kept elsewhere      |
/// | removes the second trail                                         | until the next entry makes it anew                 |
/// | does something that writes no entry                              | never                                              |
///
/// Thread: one at a time.
class AuditTrail {
 public:
  explicit AuditTrail(const Database& database) : database_(&database), second_file_(database.file() + ".audit") {}

  /// Texts longer than 1 KiB are cut.
  [[nodiscard]] core::Status append(AuditEntry entry) const;
  [[nodiscard]] core::Result<std::vector<AuditEntry>> newest(std::size_t count) const;
  [[nodiscard]] core::Result<std::uint64_t> verify() const;

 private:
  [[nodiscard]] core::Result<AuditEntry> last() const;
  [[nodiscard]] core::Status append_second(const AuditEntry& entry) const;
  [[nodiscard]] core::Status verify_second(std::uint64_t entries) const;
  [[nodiscard]] core::Status verify_line(Statement& find, const std::string& line) const;

  const Database* database_;
  std::string second_file_;
};

}  // namespace dts::record
