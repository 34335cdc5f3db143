// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/audit_trail.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

namespace dts::record {
namespace {

constexpr std::size_t kLongestText = 1024;
constexpr std::size_t kHashLetters = 64;
constexpr std::size_t kMostEntries = 10'000;
constexpr std::uint64_t kLargestNumber = std::numeric_limits<std::int64_t>::max();

constexpr const char* kColumns = "SELECT number, utc_ns, who, what, target, result, hash FROM audit ";

AuditEntry read_entry(Statement& row) {
  AuditEntry entry;
  entry.number = row.count(0);
  entry.utc_ns = row.integer(1);
  entry.who = row.text(2);
  entry.what = row.text(3);
  entry.target = row.text(4);
  entry.result = row.text(5);
  entry.hash = row.text(6);
  return entry;
}

/// Returns no value if a column has the wrong type or is out of range.
std::optional<AuditEntry> read_sound(Statement& row) {
  try {
    return read_entry(row);
  } catch (const SQLite::Exception&) {
    return std::nullopt;
  }
}

tl::unexpected<core::Error> broken(std::uint64_t number, const std::string& why) {
  return core::fail(core::ErrorCode::DataDamaged, "audit trail: entry " + std::to_string(number) + " " + why,
                    "somebody changed the catalogue, or its disk did, or a catalogue that was made again stands beside an older "
                    "catalogue.sqlite.audit: compare with a copy");
}

}  // namespace

AuditEntry AuditTrail::last() const {
  auto row = database_->query(std::string(kColumns) + "ORDER BY number DESC LIMIT 1");
  return row.step() ? read_entry(row) : AuditEntry{.hash = first_audit_hash()};
}

core::Status AuditTrail::append(AuditEntry entry) const try {
  for (std::string* text : {&entry.who, &entry.what, &entry.target, &entry.result}) text->resize(std::min(text->size(), kLongestText));
  Transaction transaction(*database_);
  const auto before = last();
  entry.number = before.number + 1;
  entry.hash = audit_hash(before.hash, entry);
  database_->run("INSERT INTO audit (number, utc_ns, who, what, target, result, hash) VALUES (?, ?, ?, ?, ?, ?, ?)", entry.number,
                 entry.utc_ns, entry.who, entry.what, entry.target, entry.result, entry.hash);
  transaction.commit();
  return append_second(entry);  // after the commit: a line without its entry would look like a removed entry
} catch (const SQLite::Exception& exception) {
  return database_->failure(exception);
}

core::Status AuditTrail::append_second(const AuditEntry& entry) const {
  const std::string line = std::to_string(entry.number) + " " + entry.hash + "\n";
  const int file = ::open(second_file_.c_str(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0640);
  const ssize_t written = file < 0 ? -1 : ::write(file, line.data(), line.size());
  const int error = errno;
  if (file >= 0) ::close(file);
  if (written == static_cast<ssize_t>(line.size())) return {};
  return core::fail_errno(written < 0 ? error : ENOSPC,
                          "audit entry " + std::to_string(entry.number) + " is in the catalogue, but was not written to " + second_file_,
                          "make room, or make the file writable for dtsd");
}

core::Result<std::vector<AuditEntry>> AuditTrail::newest(std::size_t count) const try {
  auto row = database_->query(std::string(kColumns) + "ORDER BY number DESC LIMIT ?", std::min(count, kMostEntries));
  std::vector<AuditEntry> entries;
  while (row.step()) entries.push_back(read_entry(row));
  std::ranges::reverse(entries);
  return entries;
} catch (const SQLite::Exception& exception) {
  return database_->failure(exception);
}

core::Result<std::uint64_t> AuditTrail::verify() const try {
  auto row = database_->query(std::string(kColumns) + "ORDER BY number");
  std::uint64_t entries = 0;
  std::string before = first_audit_hash();
  while (row.step()) {
    const auto entry = read_sound(row);
    if (!entry) return broken(entries + 1, "cannot be read");
    if (entry->number != entries + 1) return broken(entries + 1, "is missing");
    if (entry->hash != audit_hash(before, *entry)) return broken(entry->number, "does not fit: it or the one before it was changed");
    before = entry->hash;
    ++entries;
  }
  DTS_TRY(verify_second(entries));
  return entries;
} catch (const SQLite::Exception& exception) {
  return database_->failure(exception);
}

core::Status AuditTrail::verify_second(std::uint64_t entries) const {
  std::ifstream file(second_file_);
  if (!file) {
    if (entries == 0) return {};
    return broken(entries, "may not be the last: the second trail " + second_file_ + " is gone");
  }
  auto find = database_->query("SELECT hash FROM audit WHERE number = ?");
  std::array<char, 128> buffer{};  // our lines have at most 85 characters
  while (file.getline(buffer.data(), buffer.size()) || (file.gcount() > 0 && !file.eof())) {
    const bool is_cut = file.fail();
    file.clear(file.rdstate() & ~std::ios::failbit);
    if (is_cut) continue;
    DTS_TRY(verify_line(find, buffer.data()));
  }
  return {};
}

/// Compares a line with its entry. Ignores an invalid line (torn by a crash).
core::Status AuditTrail::verify_line(Statement& find, const std::string& line) const {
  std::uint64_t number = 0;
  const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), number);
  const auto digits = static_cast<std::size_t>(stop - line.data());
  if (error != std::errc() || number > kLargestNumber || line.size() != digits + 1 + kHashLetters || line[digits] != ' ') return {};
  find.bind(number);
  if (!find.step()) return broken(number, "was cut off: the second trail " + second_file_ + " knows it");
  if (find.text(0) == line.substr(digits + 1)) return {};
  return broken(number, "is another than in the second trail " + second_file_);
}

}  // namespace dts::record
