// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dts::record {

/// One entry of the audit trail. `hash` is SHA-256 over the hash of the previous entry and the fields of this one, so that changed, removed
/// and inserted entries are detected. For what is detected and what is not, see audit_trail.h.
struct AuditEntry {
  std::uint64_t number = 0;  ///< Counts from 1 without missing numbers.
  std::int64_t utc_ns = 0;
  std::string who;     ///< "local", "local:USER" for a user of a gateway, or "key:NAME".
  std::string what;    ///< "start_session"
  std::string target;  ///< "floor", a session's id
  std::string result;  ///< "ok", or the error code's name
  std::string hash;

  friend bool operator==(const AuditEntry&, const AuditEntry&) = default;
};

/// Returns SHA-256 in lower-case hexadecimal over
///
///     hash of the previous entry  64 bytes, as text; for the first entry: 64 times '0'
///     number, utc_ns, who, what, target, result, each as
///         length                  8 bytes, little-endian
///         text                    numbers in decimal
///
/// The lengths make the hashes of "a" + "bc" and "ab" + "c" different.
[[nodiscard]] std::string audit_hash(const std::string& before, const AuditEntry& entry);
/// Returns the "previous hash" of the first entry.
[[nodiscard]] std::string first_audit_hash();

}  // namespace dts::record
