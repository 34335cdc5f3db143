// SPDX-License-Identifier: Apache-2.0
#include "fleet/hub/audit_trail.h"

#include <algorithm>
#include <cstdint>
namespace dts::fleet::hub {
namespace {

constexpr const char* kAuditColumns = "SELECT number, utc_ns, who, what, target, result, hash FROM audit ";
constexpr std::int64_t kPage = 1000;

core::Result<record::AuditEntry> audit_entry(const Rows& rows, std::size_t row) {
  record::AuditEntry entry;
  DTS_TRY_ASSIGN(const std::int64_t number, rows.integer(row, 0));
  entry.number = static_cast<std::uint64_t>(number);
  DTS_TRY_ASSIGN(entry.utc_ns, rows.integer(row, 1));
  entry.who = rows.text(row, 2);
  entry.what = rows.text(row, 3);
  entry.target = rows.text(row, 4);
  entry.result = rows.text(row, 5);
  entry.hash = rows.text(row, 6);
  return entry;
}

tl::unexpected<core::Error> broken_audit(std::uint64_t number, const std::string& why) {
  return core::fail(core::ErrorCode::DataDamaged, "audit trail of the centre: entry " + std::to_string(number) + " " + why,
                    "the table was changed: compare with a backup, and with the hash that a clinic has received");
}

}  // namespace

core::Status append_audit(Database& database, std::int64_t utc_ns, const std::string& who, const std::string& what,
                          const std::string& target) {
  DTS_TRY(database.run("SELECT pg_advisory_xact_lock(7303562)"));  // the trail has one newest entry
  DTS_TRY_ASSIGN(const auto newest, newest_audit(database, 1));
  record::AuditEntry entry{.utc_ns = utc_ns, .who = who, .what = what, .target = target, .result = "ok"};
  entry.number = newest.empty() ? 1 : newest.front().number + 1;
  entry.hash = record::audit_hash(newest.empty() ? record::first_audit_hash() : newest.front().hash, entry);
  DTS_TRY(database.run("INSERT INTO audit (number, utc_ns, who, what, target, result, hash) VALUES ($1, $2, $3, $4, $5, $6, $7)",
                       {entry.number, entry.utc_ns, entry.who, entry.what, entry.target, entry.result, entry.hash}));
  return {};
}

core::Result<std::vector<record::AuditEntry>> newest_audit(Database& database, std::size_t count) {
  DTS_TRY_ASSIGN(const Rows rows, database.run(std::string(kAuditColumns) + "ORDER BY number DESC LIMIT $1", {count}));
  std::vector<record::AuditEntry> entries;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    DTS_TRY_ASSIGN(auto entry, audit_entry(rows, row));
    entries.push_back(std::move(entry));
  }
  std::ranges::reverse(entries);
  return entries;
}

core::Result<std::uint64_t> verify_audit(Database& database) {
  std::uint64_t entries = 0;
  std::string before = record::first_audit_hash();
  while (true) {
    DTS_TRY_ASSIGN(const Rows rows,
                   database.run(std::string(kAuditColumns) + "WHERE number > $1 ORDER BY number LIMIT $2", {entries, kPage}));
    for (std::size_t row = 0; row < rows.size(); ++row) {
      DTS_TRY_ASSIGN(const auto entry, audit_entry(rows, row));
      if (entry.number != entries + 1) return broken_audit(entries + 1, "is missing");
      if (entry.hash != record::audit_hash(before, entry))
        return broken_audit(entry.number, "does not fit: it or the one before it was changed");
      before = entry.hash;
      ++entries;
    }
    if (rows.size() < static_cast<std::size_t>(kPage)) return entries;
  }
}

}  // namespace dts::fleet::hub
