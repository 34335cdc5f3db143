// SPDX-License-Identifier: Apache-2.0
#include "record/catalogue/sqlite.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <limits>
#include <system_error>

namespace dts::record {
namespace {

using core::ErrorCode;

constexpr int kBusyTimeoutMs = 1000;              // the control thread waits so long if another program locks the file
constexpr unsigned kLongestValueBytes = 4 << 20;  // texts of recordings are at most 1 MiB

ErrorCode code_of(int result) {
  switch (result & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB: return ErrorCode::DataDamaged;
    case SQLITE_PERM:
    case SQLITE_READONLY:
    case SQLITE_AUTH: return ErrorCode::NotAllowed;
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return ErrorCode::Timeout;
    case SQLITE_TOOBIG:
    case SQLITE_RANGE: return ErrorCode::LimitExceeded;
    case SQLITE_CONSTRAINT: return ErrorCode::InvalidArgument;
    case SQLITE_MISUSE: return ErrorCode::Internal;
    default: return ErrorCode::Failed;
  }
}

std::string hint_of(int result) {
  switch (result & 0xff) {
    case SQLITE_FULL: return "make room on the disk of the state folder";
    case SQLITE_READONLY:
    case SQLITE_PERM: return "the state folder must be writable for dtsd";
    case SQLITE_BUSY:
    case SQLITE_LOCKED: return "does another program hold it? only one dtsd may use a state folder";
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN: return "is the disk of the state folder full, read-only or failing?";
    default: return "";
  }
}

/// `system_errno`: what the system said about a failed read or write; 0: nothing.
tl::unexpected<core::Error> error_of(const std::string& file, const SQLite::Exception& exception, int system_errno = 0) {
  const int result = exception.getErrorCode();
  const std::string why = exception.what();
  if (code_of(result) == ErrorCode::DataDamaged) {
    return core::fail(ErrorCode::DataDamaged, "the catalogue " + file + " is damaged: " + why,
                      "start dtsd again: it sets the catalogue aside and makes a new one from the recordings, without the audit trail");
  }
  const bool is_of_the_system = (result & 0xff) == SQLITE_IOERR || (result & 0xff) == SQLITE_CANTOPEN;
  const std::string system = is_of_the_system && system_errno != 0 ? " (" + std::system_category().message(system_errno) + ")" : "";
  return core::fail(code_of(result), "the catalogue (" + file + "): " + why + system, hint_of(result));
}

/// Creates the file with mode 0640 (SQLite would use 0644). Fails with the system's reason if the path is no usable file.
core::Status create_private(const std::string& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0640);
  if (descriptor < 0) {
    return core::fail_errno(errno, "cannot open the catalogue " + file,
                            "does the folder exist, and may dtsd write there? see directory under [storage] in dtsd.toml");
  }
  struct stat facts {};
  const bool is_file = ::fstat(descriptor, &facts) == 0 && S_ISREG(facts.st_mode);
  ::close(descriptor);
  if (is_file) return {};
  return error_of(file, SQLite::Exception("it is no ordinary file", SQLITE_CORRUPT));
}

}  // namespace

void Statement::throw_too_large(int index) { throw SQLite::Exception("value " + std::to_string(index) + " is too large", SQLITE_TOOBIG); }

void Statement::bind_at(int index, std::string_view text) {
  if (text.size() > kLongestValueBytes) throw_too_large(index);
  statement_.bind(index, std::string(text));
}

SQLite::Column Statement::cell(int column, int type) const {
  SQLite::Column cell = statement_.getColumn(column);
  if (cell.getType() == type) return cell;
  throw SQLite::Exception(std::string(cell.getName()) + " is of the wrong type", SQLITE_CORRUPT);
}

std::int64_t Statement::integer_in(int column, std::int64_t minimum, std::int64_t maximum) const {
  const std::int64_t value = integer(column);
  if (value >= minimum && value <= maximum) return value;
  throw SQLite::Exception(std::string(statement_.getColumnName(column)) + " = " + std::to_string(value), SQLITE_CORRUPT);
}

std::uint64_t Statement::count(int column) const {
  return static_cast<std::uint64_t>(integer_in(column, 0, std::numeric_limits<std::int64_t>::max()));
}

std::uint32_t Statement::count32(int column) const {
  return static_cast<std::uint32_t>(integer_in(column, 0, std::numeric_limits<std::uint32_t>::max()));
}

core::Result<Database> Database::open(const std::string& file) { return open(file, false); }
core::Result<Database> Database::open_again(const std::string& file) { return open(file, true); }

core::Result<Database> Database::open(const std::string& file, bool is_checked) {
  DTS_TRY(create_private(file));
  std::error_code error;
  const auto path = std::filesystem::absolute(file, error);  // SQLite gives some relative names a special meaning, such as ":memory:"
  if (error) return core::fail_errno(error.value(), "cannot open the catalogue " + file);
  try {
    Database database(file, path);
    database.configure();
    if (!is_checked) database.check();
    return database;
  } catch (const SQLite::Exception& exception) {
    return error_of(file, exception);
  }
}

Database::Database(std::string file, const std::string& path)
    : file_(std::move(file)), database_(path, SQLite::OPEN_READWRITE | SQLite::OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE, kBusyTimeoutMs) {}

/// Restricts what the file's schema can do, because the file may be from an untrusted person.
void Database::configure() const {
  sqlite3* handle = database_.getHandle();
  sqlite3_limit(handle, SQLITE_LIMIT_LENGTH, kLongestValueBytes);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DQS_DDL, 0, nullptr);
  sqlite3_db_config(handle, SQLITE_DBCONFIG_DQS_DML, 0, nullptr);
  execute("PRAGMA synchronous = FULL; PRAGMA foreign_keys = ON; PRAGMA secure_delete = ON; PRAGMA temp_store = MEMORY;");
}

void Database::interrupt_unless(const std::function<bool()>& is_wanted) const {
  constexpr int kStepsBetween = 1000;  // of the virtual machine: some 10 us
  const auto ask = [](void* wanted) noexcept { return (*static_cast<const std::function<bool()>*>(wanted))() ? 0 : 1; };
  sqlite3_progress_handler(database_.getHandle(), kStepsBetween, ask, const_cast<std::function<bool()>*>(&is_wanted));
}

void Database::check() const {
  auto found = query("PRAGMA quick_check(1)");
  const std::string answer = found.step() ? found.text(0) : "no answer";
  if (answer != "ok") throw SQLite::Exception(answer, SQLITE_CORRUPT);
}

std::int64_t Database::number(const std::string& sql) const {
  auto row = query(sql);
  return row.step() ? row.integer(0) : 0;
}

tl::unexpected<core::Error> Database::failure(const SQLite::Exception& exception) const {
  return error_of(file_, exception, sqlite3_system_errno(database_.getHandle()));
}

Transaction::Transaction(const Database& database) {
  // IMMEDIATE locks the file for writing now: the caller reads before it writes, and no other program may write in between.
  if (!database.is_in_transaction()) outermost_.emplace(database.database_, SQLite::TransactionBehavior::IMMEDIATE);
}

void Transaction::commit() {
  if (outermost_) outermost_->commit();
}

}  // namespace dts::record
